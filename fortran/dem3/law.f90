!> The force at the points of a contact: a spring without tension beyond that of mortar, Coulomb friction on a
!> shear spring in the plane of the contact, and dashpots in parallel with both, taken implicitly: the law of the plane
!> room with a cone (dem/law.f90).
!>
!> With the normal n from body 1 to body 2, the gap g (negative where bodies overlap), the velocity u of body 2 relative
!> to body 1 at the point and the area a that it carries:
!>
!>    N  = -k_n a g
!>    S += -k_s a u_t dt,   |S| <= mu N + c a      S turns with the contact
!>    D  = -beta k a u                              in both directions
!>
!> on body 2, the opposite on body 1. The cohesion c and the tensile strength f_t of mortar (N >= -f_t a) are lost point
!> by point at its first failure in shear or tension. The dashpots are implicit as in the plane:
!> D = -beta k a u* / (1 + beta k a dt w), with u* the velocity after the step without it and w that of a unit impulse.
module dem3_law
   use common_kinds, only : wp
   use common_status, only : status_ok
   use dem_joint, only : joint_law, spring_share
   use dem3_bodies, only : body, body_set
   use dem3_patch, only : feature, measure_feature, find_features, patch
   use dem3_pressure, only : face_room, face_room_new, press_face
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: joint_law, contact_point, contact_pair, apply_pair_law, bond_points, find_points, elastic_energy, &
      drop_points
   public :: answers, bounded, push_body, length_of

   type :: contact_point
      type(feature) :: what
      logical :: closed = .false.
      logical :: bonded = .false.                          !! cohesion and tension not lost yet
      !> Gap that mortar fills, whether it is whole or broken; below 0 the overlap at which a contact came to be [m]
      real(wp) :: filled = 0.0_wp
      real(wp) :: overlap = 0.0_wp                         !! of a face that crushes, see dem3_pressure [m]
      real(wp) :: spring_n = 0.0_wp, dash_n = 0.0_wp       !! compression positive [N]
      real(wp) :: spring_s(3) = 0.0_wp, dash_s(3) = 0.0_wp !! on the second body [N]
      real(wp) :: force(3) = 0.0_wp                        !! all of it, in the step before [N]
      real(wp) :: dash(3) = 0.0_wp                         !! of the dashpots [N]
      !> On rigid contacts: sliding velocities of the last step and of the one before [m/s]
      real(wp) :: slip(3, 2) = 0.0_wp
      real(wp) :: late(3) = 0.0_wp                         !! shear impulse that acts in the next step, see dem_rigid [N s]
   end type contact_point

   !> Two parts of different bodies that are near each other
   type :: contact_pair
      integer :: part(2) = 0
      integer :: law = 1
      integer :: joint = 0                     !! of the two bodies, 0 where they had none at the start
      integer :: points = 0
      integer :: reference = 0                 !! whose face the last polygon lay on
      integer :: marks(2) = -1                 !! of the bodies, as they were last compared; -1: never
      real(wp) :: place(3) = 0.0_wp            !! of the second body in the frame of the first, as the points were found
      real(wp) :: turn(3, 3) = 0.0_wp
      real(wp) :: friction_loss = 0.0_wp       !! [J]
      real(wp) :: damping_loss = 0.0_wp        !! [J]
      real(wp) :: support_work = 0.0_wp        !! [J]
      real(wp) :: crushed = 0.0_wp             !! energy of a face that crushes, without its springs, see dem3_pressure [J]
      logical :: lacks_memory = .false.        !! there was no room for its points: the run must end
      integer :: unsolved = 0                  !! steps in which the pressure of a face that crushes did not converge
      type(contact_point), allocatable :: point(:)
      type(face_room), allocatable :: room     !! of a face that crushes; made where it is needed
   end type contact_pair

   !> Points nearer to one found anew than this share of the root of its area are the same
   real(wp), parameter :: same = 0.5_wp
   !> and carry on as they are where they are of the same features and their area is the same but for this share
   real(wp), parameter :: still_same = 0.1_wp
   !> Of how far bodies move between two looks: overlap at which a contact may come to be with its force
   real(wp), parameter :: deep = 0.1_wp
   !> Ratio of the energies of the springs after and before a search for contacts, below which the difference is a loss
   real(wp), parameter :: lost = 0.98_wp
   !> The same ratio, above which the springs belong to other features, for instance to faces in place of crossing edges. An area
   !> that grows with the overlap, as under a keystone that settles, stays below this ratio: the contact keeps its pressure.
   real(wp), parameter :: other_springs = 1.2_wp
   !> The same ratio at which the springs of a face that crushes have been reduced enough, and how often at most
   real(wp), parameter :: near_enough = 1.01_wp
   integer, parameter :: most_parts = 20

contains

   !> Where a pair touches, looked at anew if its bodies have moved relative to each other by more than `far`; what goes
   !> on keeps its springs. The little that the springs gain or lose as the shared area changes is not recorded: it shows as an
   !> error of the energy balance. Of a face that crushes, the energy is that at its present pressure.
   pure subroutine find_points(law, set, far, margin, pair)
      type(joint_law), intent(in) :: law
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: far               !! [m]
      real(wp), intent(in) :: margin            !! [m]
      type(contact_pair), intent(inout) :: pair
      real(wp) :: place(3), turn(3, 3), held
      logical :: later, bound

      later = pair%marks(1) >= 0              ! what overlaps as a run begins is pressed together
      associate (a => set%item(set%parts(pair%part(1))%owner), b => set%item(set%parts(pair%part(2))%owner))
         place = matmul(b%x - a%x, a%turn)
         turn = matmul(transpose(a%turn), b%turn)
         if (pair%marks(1) >= 0) then
            pair%marks = [a%marks, b%marks]
            if (norm2(place - pair%place) + min(a%radius, b%radius) * norm2(turn - pair%turn) < far) return
         end if
         pair%marks = [a%marks, b%marks]
      end associate
      pair%place = place
      pair%turn = turn
      bound = .false.
      if (pair%points > 0) bound = any(pair%point(:pair%points)%bonded)
      held = 0.0_wp
      if (pair%points > 0 .and. .not. bound) call measure_held(law, set, pair, held)
      call find_anew(set, margin, law%strength > 0.0_wp, pair)
      if (pair%points == 0) pair%crushed = 0.0_wp
      if (held > 0.0_wp) then
         call keep_energy(law, set, held, pair)
      else if (later .and. .not. bound) then
         call free_of_force(set, deep * far, pair)
      end if
   end subroutine find_points

   !> Energy that the springs of a pair, and a face that crushes, hold at the present places of its bodies
   pure subroutine measure_held(law, set, pair, energy)
      type(joint_law), intent(in) :: law
      type(body_set), intent(in) :: set
      type(contact_pair), intent(inout) :: pair
      real(wp), intent(out) :: energy           !! [J]
      real(wp) :: normal(3), gap, at(3)
      logical :: converged
      integer :: i
      energy = 0.0_wp
      associate (a => set%item(set%parts(pair%part(1))%owner), b => set%item(set%parts(pair%part(2))%owner))
         if (crushes(law, pair)) call press_corners(law, a, b, pair, energy, converged)
         if (pair%lacks_memory) return
         do i = 1, pair%points
            associate (point => pair%point(i))
               if (crushes(law, pair)) then
                  gap = pair%room%force(i) / pair%room%spring(i)
               else
                  call measure_feature(point%what, a, b, normal, gap, at)
                  gap = min(gap - point%filled, 0.0_wp)
               end if
               energy = energy + 0.5_wp * law%normal_stiffness * point%what%area * gap**2 &
                  + 0.5_wp * dot_product(point%spring_s, point%spring_s) / (law%shear_stiffness * point%what%area)
            end associate
         end do
      end associate
   end subroutine measure_held

   !> Whether a pair shares a face that crushes
   pure function crushes(law, pair) result(does)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(in) :: pair
      logical :: does
      does = law%strength > 0.0_wp .and. pair%points > 2
   end function crushes

   !> Limits the energy of the springs of a pair to the energy before the search. If new features with other areas hold more, their
   !> springs are reduced; if they hold less, the difference is recorded as a loss along the normal
   pure subroutine keep_energy(law, set, held, pair)
      type(joint_law), intent(in) :: law
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: held              !! before [J]
      type(contact_pair), intent(inout) :: pair
      real(wp) :: normal(3), gap, at(3), now, part
      integer :: i, k
      call measure_held(law, set, pair, now)
      if (now < lost * held) pair%damping_loss = pair%damping_loss + held - now
      if (now <= other_springs * held) return
      ! Once for springs; the energy of a face that crushes grows with less than their square and is approached from above
      do k = 1, merge(most_parts, 1, crushes(law, pair))
         part = sqrt(held / now)
         do i = 1, pair%points
            associate (point => pair%point(i))
               call measure_feature(point%what, set%item(set%parts(pair%part(1))%owner), &
                  set%item(set%parts(pair%part(2))%owner), normal, gap, at)
               point%filled = point%filled + (1.0_wp - part) * min(gap - point%filled, 0.0_wp)
               point%spring_s = part * point%spring_s
            end associate
         end do
         if (.not. crushes(law, pair)) exit
         call measure_held(law, set, pair, now)
         if (now <= near_enough * held) exit
      end do
   end subroutine keep_energy

   !> Where a pair touches now. Apart from find_points, which is called far more often than it must search:
   !> a patch is long.
   pure subroutine find_anew(set, margin, whole, pair)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: margin            !! [m]
      logical, intent(in) :: whole              !! see find_features
      type(contact_pair), intent(inout) :: pair
      type(contact_point), allocatable :: before(:)
      type(patch) :: found
      real(wp) :: share
      integer(c_int) :: status
      integer :: i, old, failed
      logical, allocatable :: taken(:)

      call find_features(set, pair%part(1), pair%part(2), margin, whole, pair%reference, found, status)
      pair%lacks_memory = pair%lacks_memory .or. status /= status_ok
      if (status /= status_ok) return
      if (found%reference > 0) pair%reference = found%reference
      if (found%points == 0 .and. pair%points == 0) return
      pair%points = 0
      if (allocated(pair%point)) then
         call move_alloc(pair%point, before)
      else
         allocate (before(0), stat=failed)
         pair%lacks_memory = pair%lacks_memory .or. failed /= 0
         if (failed /= 0) return
      end if
      allocate (taken(size(before)), pair%point(found%points), stat=failed)
      pair%lacks_memory = pair%lacks_memory .or. failed /= 0
      if (failed /= 0) return
      taken = .false.
      do i = 1, found%points
         old = partner(found%point(i), before, taken)
         pair%point(i)%what = found%point(i)
         if (old == 0) cycle
         taken(old) = .true.
         associate (point => pair%point(i), one => before(old))
            point = one
            if (equal(one%what, found%point(i))) cycle
            ! The springs keep what they are drawn out by, so that a corner that parts in two holds
            ! the energy that it held.
            share = found%point(i)%area / one%what%area
            point%what = found%point(i)
            point%spring_n = share * one%spring_n
            point%spring_s = share * one%spring_s
         end associate
      end do
      pair%points = found%points
   end subroutine find_anew

   !> Parts that meet in an edge alone overlap a little before they share an area. Their springs begin there: with the
   !> force of that overlap at once they would gain energy.
   pure subroutine free_of_force(set, slight, pair)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: slight            !! overlap that is not worth it [m]
      type(contact_pair), intent(inout) :: pair
      real(wp) :: normal(3), gap, at(3)
      integer :: i
      do i = 1, pair%points
         call measure_feature(pair%point(i)%what, set%item(set%parts(pair%part(1))%owner), &
            set%item(set%parts(pair%part(2))%owner), normal, gap, at)
         if (gap < -slight) pair%point(i)%filled = gap
      end do
   end subroutine free_of_force

   !> Whether two points are the same corner over the same plane, or of the same edges
   pure function equal(one, two) result(same_ones)
      type(feature), intent(in) :: one
      type(feature), intent(in) :: two
      logical :: same_ones
      same_ones = one%kind == two%kind .and. .not. any(abs(one%own - two%own) > 0.0_wp) &
         .and. .not. any(abs(one%normal - two%normal) > 0.0_wp) .and. .not. any(abs(one%along - two%along) > 0.0_wp) &
         .and. .not. any(abs(one%other - two%other) > 0.0_wp) &
         .and. abs(one%area - two%area) < still_same * two%area
   end function equal

   !> All points of a pair are no more: what their springs held is lost with them
   pure subroutine drop_points(law, pair)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(inout) :: pair
      pair%friction_loss = pair%friction_loss + elastic_energy(law, pair)
      pair%points = 0
      pair%crushed = 0.0_wp
   end subroutine drop_points

   !> The closed point of before that a new one is; 0 where there is none
   pure function partner(what, before, taken) result(old)
      type(feature), intent(in) :: what
      type(contact_point), intent(in) :: before(:)
      logical, intent(in) :: taken(:)
      integer :: old
      integer :: k
      real(wp) :: away, nearest
      old = 0
      nearest = huge(1.0_wp)
      do k = 1, size(before)
         if (taken(k)) cycle
         away = norm2(what%at - before(k)%what%at)
         if (away > same * sqrt(max(what%area, before(k)%what%area)) .or. away >= nearest) cycle
         nearest = away
         old = k
      end do
   end function partner

   !> Mortar binds the points of a pair whose gap is less than a margin, where its law has any, and fills that gap
   pure subroutine bond_points(law, margin, a, b, pair)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: margin            !! [m]
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(contact_pair), intent(inout) :: pair
      real(wp) :: normal(3), gap, at(3)
      integer :: i
      if (.not. max(law%cohesion, law%tension) > 0.0_wp) return
      do i = 1, pair%points
         call measure_feature(pair%point(i)%what, a, b, normal, gap, at)
         pair%point(i)%bonded = gap <= margin
         if (pair%point(i)%bonded) pair%point(i)%filled = max(gap, 0.0_wp)
      end do
   end subroutine bond_points

   !> Forces of a pair at its present overlap, added to both bodies; predicted velocities follow
   pure subroutine apply_pair_law(law, kick, drift, a, b, pair)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! length of the velocity step [s]
      real(wp), intent(in) :: drift             !! length of the position step before [s]
      type(body), intent(inout) :: a
      type(body), intent(inout) :: b
      type(contact_pair), intent(inout) :: pair
      real(wp) :: normal(3), gap, at(3), arm_a(3), arm_b(3), u(3), force(3), dash(3)
      type(joint_law) :: own
      logical :: has_face
      integer :: i

      own = law
      has_face = crushes(law, pair)
      pair%crushed = 0.0_wp
      if (has_face) call crush_face(law, a, b, pair)
      if (pair%lacks_memory) return
      do i = 1, pair%points
         associate (point => pair%point(i))
            call measure_feature(point%what, a, b, normal, gap, at)
            if (gap >= 0.0_wp) point%filled = max(point%filled, 0.0_wp)
            gap = gap - point%filled
            if (has_face) then
               gap = pair%room%gap(i)
               own%damping = pair%room%elastic(i) * law%damping
            end if
            if (gap >= 0.0_wp) then
               ! Mortar that is torn farther than its strength is gone for good.
               point%bonded = point%bonded .and. law%normal_stiffness * gap <= law%tension
               if (.not. (point%closed .or. point%bonded)) cycle
            end if
            arm_a = at - a%x
            arm_b = at - b%x
            ! Velocity over the position step before: it has moved the springs.
            u = b%v - a%v + cross(b%spin, arm_b) - cross(a%spin, arm_a)
            if (gap < 0.0_wp .or. point%bonded) then
               point%closed = .true.
               call press_point(own, kick, drift, normal, gap, u, arm_a, arm_b, a, b, point, pair%friction_loss, &
                  force, dash)
               if (.not. a%fixed) a%touched = .true.
               if (.not. b%fixed) b%touched = .true.
            else   ! it opens: what its shear spring held is lost, and its other one if mortar was torn
               pair%friction_loss = pair%friction_loss &
                  + 0.5_wp * (dot_product(point%spring_s, point%spring_s) / law%shear_stiffness &
                  + min(point%spring_n, 0.0_wp)**2 / law%normal_stiffness) / point%what%area
               point%closed = .false.
               point%spring_n = 0.0_wp
               point%spring_s = 0.0_wp
               point%dash_n = 0.0_wp
               point%dash_s = 0.0_wp
               force = 0.0_wp
               dash = 0.0_wp
            end if
            pair%damping_loss = pair%damping_loss - 0.5_wp * drift * dot_product(point%dash + dash, u)
            if (a%fixed) pair%support_work = pair%support_work &
               + 0.5_wp * drift * dot_product(force + point%force, a%v + cross(a%spin, arm_a))
            if (b%fixed) pair%support_work = pair%support_work &
               - 0.5_wp * drift * dot_product(force + point%force, b%v + cross(b%spin, arm_b))
            call push_body(a, -force, -kick * (force - point%force), arm_a)
            call push_body(b, force, kick * (force - point%force), arm_b)
            point%force = force
            point%dash = dash
         end associate
      end do
   end subroutine apply_pair_law

   !> Gaps at which the springs of the corners have the forces of a face that crushes, in place of those measured: in the room of the pair
   pure subroutine crush_face(law, a, b, pair)
      type(joint_law), intent(in) :: law
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(contact_pair), intent(inout) :: pair
      logical :: converged
      integer :: i
      call press_corners(law, a, b, pair, pair%crushed, converged)
      if (pair%lacks_memory) return
      if (.not. converged) pair%unsolved = pair%unsolved + 1
      associate (gap => pair%room%gap, force => pair%room%force, spring => pair%room%spring, overlap => pair%room%overlap)
         do i = 1, pair%points
            pair%room%elastic(i) = spring_share((force(i) - pair%point(i)%spring_n) / spring(i), &
               max(overlap(i), 0.0_wp) - max(pair%point(i)%overlap, 0.0_wp), gap(i) >= 0.0_wp)
            pair%point(i)%overlap = overlap(i)
            gap(i) = merge(-force(i) / spring(i), max(gap(i), 0.0_wp), force(i) > 0.0_wp)
         end do
      end associate
   end subroutine crush_face

   !> Forces of the corners of a face that crushes at the present places, and the gaps measured, into the room of the pair
   pure subroutine press_corners(law, a, b, pair, energy, converged)
      type(joint_law), intent(in) :: law
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(contact_pair), intent(inout) :: pair
      real(wp), intent(out) :: energy           !! of the face, without that of the springs [J]
      logical, intent(out) :: converged
      real(wp) :: normal(3), at(3)
      integer :: i
      energy = 0.0_wp
      converged = .true.
      call make_room(pair)
      if (pair%lacks_memory) return
      associate (gap => pair%room%gap)
         do i = 1, pair%points
            call measure_feature(pair%point(i)%what, a, b, normal, gap(i), at)
            gap(i) = gap(i) - merge(max(pair%point(i)%filled, 0.0_wp), pair%point(i)%filled, gap(i) >= 0.0_wp)
            pair%room%corner(:, i) = pair%point(i)%what%at
            pair%room%spring(i) = law%normal_stiffness * pair%point(i)%what%area
            pair%room%trial(i) = -pair%room%spring(i) * gap(i)
            pair%room%overlap(i) = pair%point(i)%overlap
         end do
      end associate
      call press_face(law%normal_stiffness, law%strength, pair%room, energy, converged)
   end subroutine press_corners

   !> Room for a face of as many corners as a pair has points
   pure subroutine make_room(pair)
      type(contact_pair), intent(inout) :: pair
      integer(c_int) :: status
      integer :: failed
      if (allocated(pair%room)) then
         if (size(pair%room%gap) == pair%points) return
         deallocate (pair%room)
      end if
      allocate (pair%room, stat=failed)
      status = status_ok
      if (failed == 0) call face_room_new(pair%points, pair%room, status)
      pair%lacks_memory = pair%lacks_memory .or. failed /= 0 .or. status /= status_ok
   end subroutine make_room

   !> Force of a closed point: springs, the normal dashpot, then friction on the shear spring and its dashpot
   pure subroutine press_point(law, kick, drift, normal, gap, u, arm_a, arm_b, a, b, point, friction_loss, force, dash)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: drift             !! [s]
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: gap               !! [m]
      real(wp), intent(in) :: u(3)              !! relative velocity over the position step before [m/s]
      real(wp), intent(in) :: arm_a(3)          !! from the centroids [m]
      real(wp), intent(in) :: arm_b(3)
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(contact_point), intent(inout) :: point
      real(wp), intent(inout) :: friction_loss  !! [J]
      real(wp), intent(out) :: force(3)         !! on the second body [N]
      real(wp), intent(out) :: dash(3)          !! the dashpots' part of it
      real(wp) :: slip(3), predicted(3), star(3), trial(3), held(3), new(3), change(3), answer(3, 3)
      real(wp) :: stiff_n, stiff_s, viscous, w, square, bound, push_n, spring_n, dash_n, held_by_mortar

      stiff_n = law%normal_stiffness * point%what%area
      stiff_s = law%shear_stiffness * point%what%area
      slip = u - dot_product(u, normal) * normal
      ! The shear spring turns into the present plane and keeps its force.
      held = point%spring_s - dot_product(point%spring_s, normal) * normal
      square = dot_product(held, held)
      if (square > 0.0_wp) held = held * sqrt(dot_product(point%spring_s, point%spring_s) / square)
      trial = held - (stiff_s * drift) * slip
      spring_n = -stiff_n * gap
      answer = answers(arm_a, arm_b, a, b)
      predicted = b%p - a%p + cross(b%pspin, arm_b) - cross(a%pspin, arm_a)
      ! Normal dashpot: the predicted velocity holds the old force of this point, of the others what is decided by now.
      held_by_mortar = merge(law%cohesion * point%what%area, 0.0_wp, point%bonded)
      bound = law%friction * max(spring_n + point%dash_n, 0.0_wp) + held_by_mortar
      new = bounded(trial + point%dash_s, bound)
      change = (spring_n + point%dash_n) * normal + new - point%force
      star = predicted + kick * matmul(answer, change)
      w = dot_product(normal, matmul(answer, normal))
      viscous = law%damping * stiff_n
      dash_n = -viscous * (dot_product(star, normal) - kick * w * point%dash_n) / (1.0_wp + viscous * kick * w)
      ! A dashpot never pulls more than the mortar can carry.
      push_n = max(spring_n + dash_n, merge(-law%tension * point%what%area, 0.0_wp, point%bonded))
      ! Shear, now that the normal force is known; mortar may break.
      bound = max(law%friction * push_n + held_by_mortar, 0.0_wp)
      if (point%bonded .and. dot_product(trial, trial) > bound**2) then
         point%bonded = .false.
         bound = max(law%friction * push_n, 0.0_wp)
      end if
      if (dot_product(trial, trial) >= bound**2) then
         new = bounded(trial, bound)
         ! Mean force over the step times the slip.
         friction_loss = friction_loss + 0.5_wp * dot_product(trial - new, held + new) / stiff_s
         point%spring_s = new
         point%dash_s = 0.0_wp
      else
         change = push_n * normal + trial + point%dash_s - point%force
         star = predicted + kick * matmul(answer, change)
         star = star - dot_product(star, normal) * normal
         square = dot_product(star, star)
         held = 0.0_wp
         if (square > 0.0_wp) then
            w = dot_product(star, matmul(answer, star)) / square
            viscous = law%damping * stiff_s
            held = -viscous * (star - kick * w * point%dash_s) / (1.0_wp + viscous * kick * w)
         end if
         point%dash_s = bounded(trial + held, bound) - trial
         point%spring_s = trial
      end if
      point%spring_n = spring_n
      point%dash_n = push_n - spring_n
      dash = point%dash_n * normal + point%dash_s
      force = push_n * normal + point%spring_s + point%dash_s
   end subroutine press_point

   !> Cross product; that of dem3_bodies would not be inlined here, at a third of the time of a point
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3)
      real(wp), intent(in) :: b(3)
      real(wp) :: c(3)
      c(1) = a(2) * b(3) - a(3) * b(2)
      c(2) = a(3) * b(1) - a(1) * b(3)
      c(3) = a(1) * b(2) - a(2) * b(1)
   end function cross

   !> Length of a vector: norm2 guards against overflow, which costs more than all else
   pure function length_of(vector) result(length)
      real(wp), intent(in) :: vector(3)
      real(wp) :: length
      length = sqrt(vector(1)**2 + vector(2)**2 + vector(3)**2)
   end function length_of

   !> A vector no longer than a bound
   pure function bounded(vector, bound) result(short)
      real(wp), intent(in) :: vector(3)
      real(wp), intent(in) :: bound
      real(wp) :: short(3)
      real(wp) :: square
      square = dot_product(vector, vector)
      short = vector
      if (square > bound**2) short = vector * (bound / sqrt(square))
   end function bounded

   !> Relative velocity at a point by a unit impulse on body 2 and its opposite on body 1 [1/kg]
   pure function answers(arm_a, arm_b, a, b) result(w)
      real(wp), intent(in) :: arm_a(3)          !! [m]
      real(wp), intent(in) :: arm_b(3)
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      real(wp) :: w(3, 3)
      integer :: k
      w = 0.0_wp
      do k = 1, 3
         w(k, k) = a%inverse_mass + b%inverse_mass
      end do
      if (.not. a%fixed) call add_turning(arm_a, a%inverse, w)
      if (.not. b%fixed) call add_turning(arm_b, b%inverse, w)
   end function answers

   !> -[r] J [r], with J the inverse inertia: symmetric
   pure subroutine add_turning(r, inverse, w)
      real(wp), intent(in) :: r(3)
      real(wp), intent(in) :: inverse(3, 3)
      real(wp), intent(inout) :: w(3, 3)
      real(wp) :: m(3, 3)
      integer :: k
      do k = 1, 3                               ! rows of [r] J: r x the columns of J
         m(:, k) = cross(r, inverse(:, k))
      end do
      ! Times -[r] from the right: r x the rows.
      w(1, 1) = w(1, 1) + r(2) * m(1, 3) - r(3) * m(1, 2)
      w(1, 2) = w(1, 2) + r(3) * m(1, 1) - r(1) * m(1, 3)
      w(1, 3) = w(1, 3) + r(1) * m(1, 2) - r(2) * m(1, 1)
      w(2, 2) = w(2, 2) + r(3) * m(2, 1) - r(1) * m(2, 3)
      w(2, 3) = w(2, 3) + r(1) * m(2, 2) - r(2) * m(2, 1)
      w(3, 3) = w(3, 3) + r(1) * m(3, 2) - r(2) * m(3, 1)
      w(2, 1) = w(1, 2)
      w(3, 1) = w(1, 3)
      w(3, 2) = w(2, 3)
   end subroutine add_turning

   !> Add a force to a body, and its change to the body's predicted velocity
   pure subroutine push_body(b, force, impulse, arm)
      type(body), intent(inout) :: b
      real(wp), intent(in) :: force(3)          !! [N]
      real(wp), intent(in) :: impulse(3)        !! change of the force times the step [N s]
      real(wp), intent(in) :: arm(3)            !! [m]
      real(wp) :: swing(3)
      if (b%fixed) return
      b%force = b%force + force
      b%moment = b%moment + cross(arm, force)
      b%p = b%p + b%inverse_mass * impulse
      swing = cross(arm, impulse)
      b%pspin = b%pspin + matmul(b%inverse, swing)
   end subroutine push_body

   !> Energy in the springs of a point [J]
   pure function energy_of(law, point) result(energy)
      type(joint_law), intent(in) :: law
      type(contact_point), intent(in) :: point
      real(wp) :: energy
      energy = 0.5_wp * (point%spring_n**2 / law%normal_stiffness &
         + dot_product(point%spring_s, point%spring_s) / law%shear_stiffness) / point%what%area
   end function energy_of

   !> Energy in the springs of a pair [J]
   pure function elastic_energy(law, pair) result(energy)
      type(joint_law), intent(in) :: law
      type(contact_pair), intent(in) :: pair
      real(wp) :: energy
      integer :: k
      energy = pair%crushed
      do k = 1, pair%points
         if (pair%point(k)%closed) energy = energy + energy_of(law, pair%point(k))
      end do
   end function elastic_energy

end module dem3_law
