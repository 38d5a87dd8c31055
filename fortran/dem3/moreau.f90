!> Steps of blocks in space without springs, see dem_rigid: each corner of the polygons in which faces meet, and each
!> place where edges cross, is a contact point with a round friction cone.
!>
!> The unknowns are the velocities of the centroids and the spins about the bodies' own axes at the start of the step,
!> where their inertia is three numbers. The impulses change the swings; free rotation turns the bodies between them, as
!> in the steps with springs.
module dem3_moreau
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_rigid, only : bear_mortar, find_reversal, gives_way, has_mortar, mortar_fails, number_bodies, parting, &
      solve_step, steady
   use dem3_bodies, only : body, cross, turn_freely
   use dem3_dowels, only : place_dowel
   use dem3_law, only : contact_pair, contact_point
   use dem3_model, only : look_anew, predict_velocity, prepare_step, pull_ties, solid_model
   use dem3_patch, only : measure_feature
   use nonsmooth_impulses, only : along_normal, along_tangent, find_point_rate, impulse_problem, in_space, &
      problem_room
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: number_unknowns, solve_contacts, greatest_speed

   integer, parameter :: freedoms = 6

contains

   !> Greatest speed of a body, at its farthest vertex at the most [m/s]
   pure function greatest_speed(model) result(speed)
      type(solid_model), intent(in) :: model
      real(wp) :: speed
      integer :: k
      speed = 0.0_wp
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (.not. b%fixed) speed = max(speed, norm2(b%v) + b%radius * norm2(matmul(b%inverse, b%swing)))
         end associate
      end do
   end function greatest_speed

   !> Order of the unknowns after a search
   subroutine number_unknowns(model, status)
      type(solid_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer, allocatable :: bodies(:, :)
      logical, allocatable :: fixed(:)              ! as it stands in the bodies it would be copied, unchecked
      integer :: k, failed

      status = status_out_of_memory
      associate (rigid => model%rigid, item => model%set%item)
         if (.not. allocated(model%ahead)) then
            allocate (model%ahead(size(item)), stat=failed)
            if (failed /= 0) return
         end if
         allocate (bodies(2, model%pairs + size(model%dowels)), fixed(size(item)), stat=failed)
         if (failed /= 0) return
         do k = 1, size(fixed)
            fixed(k) = item(k)%fixed
         end do
         do k = 1, model%pairs
            bodies(:, k) = model%set%parts(model%pair(k)%part)%owner
         end do
         do k = 1, size(model%dowels)
            bodies(:, model%pairs + k) = model%dowels(k)%body
         end do
         call number_bodies(rigid, in_space, fixed, bodies, status)
         if (status /= status_ok) return
         rigid%pairs = model%pairs
         do k = 1, size(item)
            if (rigid%node(k) == 0) cycle
            associate (at => freedoms * rigid%node(k))
               rigid%problem%mass(at - 5:at - 3) = item(k)%mass
               rigid%problem%mass(at - 2:at) = item(k)%inertia
            end associate
         end do
      end associate
   end subroutine number_unknowns

   !> Room for all points of all pairs
   subroutine make_problem_room(model, points, status)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: points
      integer(c_int), intent(out) :: status
      integer :: room, failed
      status = status_ok
      associate (rigid => model%rigid)
         room = -1
         ! After a search the problem is new, and has none, not even for no points
         if (allocated(rigid%problem%friction)) room = size(rigid%problem%friction)
         if (room >= points .and. allocated(model%number)) return
         room = points + points / 2
         if (allocated(model%number)) deallocate (model%number)
         allocate (model%number(room), stat=failed)
         status = merge(status_ok, status_out_of_memory, failed == 0)
         if (status == status_ok) call problem_room(rigid%problem, room, model%pairs + size(model%dowels), &
            status)
      end associate
   end subroutine make_problem_room

   !> Forces of all contacts in the next step, added to the bodies
   subroutine solve_contacts(model, status)
      type(solid_model), intent(inout) :: model
      integer(c_int), intent(out) :: status         !! out_of_memory, not_finite where a velocity is no number, or ok
      integer :: k, first

      call prepare_step(model)
      associate (rigid => model%rigid, problem => model%rigid%problem)
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (model%quasi_static .and. .not. b%fixed) then
                  b%v = 0.0_wp
                  b%swing = 0.0_wp
               end if
               call predict_velocity(model, b)
            end associate
         end do
         call pull_ties(model)
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               model%ahead(k) = b
               model%ahead(k)%x = b%x + model%step * merge(b%p, b%v, b%fixed)
               if (b%fixed) cycle
               call turn_freely(model%ahead(k), model%step)
               call set_rate(problem, rigid%node(k), b, model%kick, model%pull)
            end associate
         end do
         do k = 1, model%pairs
            call look_anew(model, model%pair(k))
            if (model%pair(k)%lacks_memory) status = status_out_of_memory
            if (model%pair(k)%lacks_memory) return
         end do
         call make_problem_room(model, sum(model%pair(:model%pairs)%points) + size(model%dowels), status)
         if (status /= status_ok) return
         problem%points = 0
         first = 1
         do k = 1, model%pairs
            associate (last => first + model%pair(k)%points - 1)
               call gather_points(model, model%pair(k), model%number(first:last))
            end associate
            first = first + model%pair(k)%points
         end do
         first = problem%points
         call gather_dowels(model)
         call solve_step(rigid, model%model_clock, status)
         call apply_dowels(model, first)
         first = 1
         do k = 1, model%pairs
            associate (last => first + model%pair(k)%points - 1)
               call apply_impulses(model, model%pair(k), model%number(first:last))
            end associate
            first = first + model%pair(k)%points
         end do
      end associate
   end subroutine solve_contacts

   !> Velocities of a body before the step, and as they would be after it without contacts
   pure subroutine set_rate(problem, rank, b, kick, pull)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: rank
      type(body), intent(in) :: b
      real(wp), intent(in) :: kick                  !! [s]
      real(wp), intent(in) :: pull(3)               !! body force [m/s^2]
      associate (at => freedoms * rank)
         problem%rate(at - 5:at - 3) = b%v
         problem%rate(at - 2:at) = matmul(b%spin, b%turn)
         problem%free(at - 5:at - 3) = b%v + kick * (b%force * b%inverse_mass + pull)
         problem%free(at - 2:at) = problem%rate(at - 2:at) + kick * matmul(b%moment, b%turn) / b%inertia
      end associate
   end subroutine set_rate

   !> Normal from the first body to the second and two tangents at right angles with it
   pure function frame_of(normal) result(frame)
      real(wp), intent(in) :: normal(3)
      real(wp) :: frame(3, in_space)
      real(wp) :: axis(3)
      axis = 0.0_wp
      axis(minloc(abs(normal), dim=1)) = 1.0_wp
      frame(:, along_normal) = normal
      frame(:, 2) = cross(normal, axis)
      frame(:, 2) = frame(:, 2) / norm2(frame(:, 2))
      frame(:, 3) = cross(normal, frame(:, 2))
   end function frame_of

   !> The points of a pair that may press in this step, into the problem
   pure subroutine gather_points(model, pair, number)
      type(solid_model), intent(inout) :: model
      type(contact_pair), intent(in) :: pair
      integer, intent(out) :: number(:)             !! (points) of each in the problem, 0 where it cannot press
      real(wp) :: normal(3), frame(3, in_space), gap, next_gap, at(3), next_at(3), u(3), still(3), filled
      integer :: i, n, side, who(2)
      logical :: bonded

      number = 0
      who = model%set%parts(pair%part)%owner
      associate (a => model%set%item(who(1)), b => model%set%item(who(2)), rigid => model%rigid, &
                 problem => model%rigid%problem)
         do i = 1, pair%points
            call measure_feature(pair%point(i)%what, model%ahead(who(1)), model%ahead(who(2)), normal, next_gap, &
               next_at)
            call measure_feature(pair%point(i)%what, a, b, normal, gap, at)
            if (min(gap, next_gap) > model%margin) cycle
            bonded = pair%point(i)%bonded .and. has_mortar(model%law(pair%law))
            filled = max(pair%point(i)%filled, 0.0_wp)
            n = problem%points + 1
            problem%points = n
            number(i) = n
            frame = frame_of(normal)
            problem%node(:, n) = rigid%node(who)
            call set_rows(a, b, at, frame, problem%row(:, :, :, n), u, still)
            problem%shift(along_normal, n) = still(along_normal) + parting(rigid, model%step, gap - filled, &
               next_gap - filled, u(along_normal) + still(along_normal), bonded)
            problem%shift(along_tangent:, n) = still(along_tangent:)
            problem%friction(n) = model%law(pair%law)%friction
            call bear_mortar(rigid, model%law(pair%law), n, merge(pair%point(i)%what%area * model%kick, 0.0_wp, bonded))
            problem%impulse(:, n) = model%kick * matmul(pair%point(i)%force, frame)
            if (.not. any(abs(pair%point(i)%late) > 0.0_wp)) cycle
            do side = 1, 2
               associate (at => freedoms * problem%node(side, n))
                  if (at > 0) problem%free(at - 5:at) = problem%free(at - 5:at) &
                     + (dot_product(pair%point(i)%late, frame(:, 2)) * problem%row(:, side, 2, n) &
                     + dot_product(pair%point(i)%late, frame(:, 3)) * problem%row(:, side, 3, n)) / problem%mass(at - 5:at)
               end associate
            end do
         end do
      end associate
   end subroutine gather_points

   !> Rows of a point for the velocities of both bodies, and its relative velocities in the last step
   pure subroutine set_rows(a, b, at, frame, row, u, still)
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp), intent(in) :: frame(3, in_space)    !! directions
      real(wp), intent(out) :: row(freedoms, 2, in_space)
      real(wp), intent(out) :: u(in_space)          !! by the mobile bodies, along the directions [m/s]
      real(wp), intent(out) :: still(in_space)      !! by supports, which move as in the next step [m/s]
      u = 0.0_wp
      still = 0.0_wp
      call add_side(a, -1.0_wp, at, frame, row(:, 1, :), u, still)
      call add_side(b, 1.0_wp, at, frame, row(:, 2, :), u, still)
   end subroutine set_rows

   !> The part of one body
   pure subroutine add_side(c, sense, at, frame, row, u, still)
      type(body), intent(in) :: c
      real(wp), intent(in) :: sense                 !! -1 for the first body, 1 for the second
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp), intent(in) :: frame(3, in_space)
      real(wp), intent(out) :: row(:, :)            !! (freedoms, direction)
      real(wp), intent(inout) :: u(in_space)        !! [m/s]
      real(wp), intent(inout) :: still(in_space)    !! [m/s]
      real(wp) :: arm(3), lever(3)
      integer :: d
      arm = at - c%x
      do d = 1, in_space
         lever = cross(arm, frame(:, d))
         row(1:3, d) = sense * frame(:, d)
         row(4:6, d) = sense * matmul(lever, c%turn)
         if (c%fixed) then
            still(d) = still(d) + sense * dot_product(frame(:, d), c%p)
         else
            u(d) = u(d) + sense * (dot_product(frame(:, d), c%v) + dot_product(lever, c%spin))
         end if
      end do
   end subroutine add_side

   !> Dowels that are in, as points without a normal whose shear is bounded by the strength
   pure subroutine gather_dowels(model)
      type(solid_model), intent(inout) :: model
      real(wp) :: at(3), next_at(3), away(3), next_away(3), axis(3), next_axis(3), frame(3, in_space), u(3), still(3)
      real(wp) :: offset(3)
      integer :: k, n
      associate (rigid => model%rigid, problem => model%rigid%problem)
         do k = 1, size(model%dowels)
            associate (one => model%dowels(k), a => model%set%item(model%dowels(k)%body(1)), &
                       b => model%set%item(model%dowels(k)%body(2)))
               call place_dowel(one, a, b, at, away, axis)
               one%is_out = one%is_out .or. dot_product(away, axis) > one%reach
               if (one%is_out) cycle
               call place_dowel(one, model%ahead(one%body(1)), model%ahead(one%body(2)), next_at, next_away, next_axis)
               frame = frame_of(axis)
               n = problem%points + 1
               problem%points = n
               problem%node(:, n) = rigid%node(one%body)
               call set_rows(a, b, at, frame, problem%row(:, :, :, n), u, still)
               problem%row(:, :, along_normal, n) = 0.0_wp
               ! The offset from where it slipped to is none at the end of the step, seen from the first body
               offset = matmul(next_away, model%ahead(one%body(1))%turn) - one%slip
               offset = matmul(a%turn, offset)
               problem%shift(:, n) = matmul(offset, frame) / model%step - u
               problem%shift(along_normal, n) = 0.0_wp
               problem%friction(n) = 0.0_wp
               problem%cohesion(n) = one%strength * model%kick
               problem%tension(n) = 0.0_wp
               problem%impulse(:, n) = model%kick * matmul(one%spring, frame)
               problem%impulse(along_normal, n) = 0.0_wp
            end associate
         end do
      end associate
   end subroutine gather_dowels

   !> The impulses of the dowels as forces on their bodies; beyond their strength they slip
   pure subroutine apply_dowels(model, first)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: first                  !! points before them in the problem
      real(wp), parameter :: yields = 1.0_wp - 1.0e-9_wp   !! of the strength
      real(wp) :: at(3), away(3), axis(3), frame(3, in_space), force(3), both(3), u(3)
      integer :: k, n
      n = first
      do k = 1, size(model%dowels)
         associate (one => model%dowels(k), a => model%set%item(model%dowels(k)%body(1)), &
                    b => model%set%item(model%dowels(k)%body(2)), problem => model%rigid%problem)
            call place_dowel(one, a, b, at, away, axis)
            force = 0.0_wp
            if (.not. one%is_out) then
               n = n + 1
               frame = frame_of(axis)
               force = (problem%impulse(2, n) * frame(:, 2) + problem%impulse(3, n) * frame(:, 3)) / model%kick
               if (norm2(force) > yields * one%strength) then
                  u = find_point_rate(problem, n)
                  u = model%step * (u(2) * frame(:, 2) + u(3) * frame(:, 3))
                  one%slip = one%slip + matmul(u, a%turn)
                  one%most_slip = max(one%most_slip, norm2(one%slip))
               end if
            end if
            both = one%spring + force
            u = velocity(b, at) - velocity(a, at)
            one%friction_loss = one%friction_loss - 0.5_wp * model%drift * dot_product(both, u)
            if (a%fixed) one%support_work = one%support_work + 0.5_wp * model%drift * dot_product(both, a%v)
            if (b%fixed) one%support_work = one%support_work - 0.5_wp * model%drift * dot_product(both, b%v)
            one%spring = force
            call push_body(a, -force, at)
            call push_body(b, force, at)
         end associate
      end do
   end subroutine apply_dowels

   !> Shear impulses that are due to the points of a pair in the next step, as sliding has reversed; keeps the sliding velocities.
   !> Those that were due in this step are added to the impulses
   pure subroutine find_late(model, pair, number)
      type(solid_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      integer, intent(in) :: number(:)              !! (points) of each in the problem, 0 where it cannot press
      real(wp) :: w(3), old(3), due(3), held, bound, share
      logical :: reverses
      integer :: i, d
      held = 0.0_wp
      bound = 0.0_wp
      do i = 1, pair%points
         if (.not. is_turning(model, pair%point(i), number(i))) cycle
         old = pair%point(i)%slip(:, 1)
         associate (problem => model%rigid%problem, p => model%rigid%problem%impulse(:, number(i)))
            held = held + dot_product(old, shear_of(problem, number(i), p)) / norm2(old)
            bound = bound + problem%friction(number(i)) * p(along_normal)
         end associate
      end do
      do i = 1, pair%points
         associate (point => pair%point(i), problem => model%rigid%problem)
            old = point%slip(:, 1)
            due = 0.0_wp
            if (is_turning(model, point, number(i))) then
               call find_reversal(dot_product(point%slip(:, 2), old) / norm2(old), norm2(old), held, bound, reverses, share)
               if (reverses) due = share * problem%friction(number(i)) * problem%impulse(along_normal, number(i)) &
                  * old / norm2(old) - shear_of(problem, number(i), problem%impulse(:, number(i)))
            end if
            w = 0.0_wp
            if (number(i) > 0) then
               if (gives_way(model%rigid, model%model_clock, number(i))) w = shear_of(problem, number(i), &
                  find_point_rate(problem, number(i)))
               do d = along_tangent, in_space
                  problem%impulse(d, number(i)) = problem%impulse(d, number(i)) &
                     + dot_product(point%late, problem%row(1:3, 2, d, number(i)))
               end do
            end if
            point%slip(:, 2) = merge(old, 0.0_wp, dot_product(w, old) > 0.0_wp)
            point%slip(:, 1) = w
            point%late = due
         end associate
      end do
   end subroutine find_late

   !> Whether a dry point that slid does not slide on, without an impact
   pure function is_turning(model, point, k) result(turns)
      type(solid_model), intent(in) :: model
      type(contact_point), intent(in) :: point
      integer, intent(in) :: k                      !! in the problem, 0: it cannot press
      logical :: turns
      turns = k > 0 .and. any(abs(point%slip(:, 1)) > 0.0_wp) .and. .not. point%bonded
      if (.not. turns) return
      associate (problem => model%rigid%problem, p => model%rigid%problem%impulse(along_normal, k))
         turns = dot_product(shear_of(problem, k, find_point_rate(problem, k)), point%slip(:, 1)) &
            <= 0.0_wp .or. .not. gives_way(model%rigid, model%model_clock, k)
         if (turns) turns = abs(p - model%kick * dot_product(point%force, problem%row(1:3, 2, along_normal, k))) &
            < steady * p
      end associate
   end function is_turning

   !> The part along the tangents of values along the normal and the tangents of a point
   pure function shear_of(problem, k, value) result(shear)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp), intent(in) :: value(in_space)
      real(wp) :: shear(3)
      shear = value(2) * problem%row(1:3, 2, 2, k) + value(3) * problem%row(1:3, 2, 3, k)
   end function shear_of

   !> A force at a place, added to a body unless it is a support
   pure subroutine push_body(b, force, at)
      type(body), intent(inout) :: b
      real(wp), intent(in) :: force(3)              !! [N]
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp) :: lever(3)
      if (b%fixed) return
      b%force = b%force + force
      lever = cross(at - b%x, force)
      b%moment = b%moment + lever
      b%touched = .true.
   end subroutine push_body

   !> The impulses of a pair as forces on its bodies, and what they took
   pure subroutine apply_impulses(model, pair, number)
      type(solid_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      integer, intent(in) :: number(:)              !! (points) of each in the problem, 0 where it cannot press
      real(wp) :: frame(3, in_space), normal(3), gap, at(3), force(3), both(3), u(3), by_normal
      integer :: i, who(2)

      who = model%set%parts(pair%part)%owner
      associate (a => model%set%item(who(1)), b => model%set%item(who(2)))
         call find_late(model, pair, number)
         do i = 1, pair%points
            associate (point => pair%point(i))
               if (number(i) == 0 .and. .not. point%closed) cycle
               call measure_feature(point%what, a, b, normal, gap, at)
               force = 0.0_wp
               if (number(i) > 0) then
                  frame = frame_of(normal)
                  force = matmul(frame, model%rigid%problem%impulse(:, number(i))) / model%kick
               end if
               if (point%bonded .and. number(i) > 0) then
                  point%bonded = .not. mortar_fails(model%rigid, model%model_clock, number(i))
               end if
               point%closed = any(abs(force) > 0.0_wp)
               ! Mean force over the position step before, times the velocity that led through it.
               u = velocity(b, at) - velocity(a, at)
               both = point%force + force
               by_normal = dot_product(both, normal) * dot_product(u, normal)
               pair%damping_loss = pair%damping_loss - 0.5_wp * model%drift * by_normal
               pair%friction_loss = pair%friction_loss - 0.5_wp * model%drift * (dot_product(both, u) - by_normal)
               if (a%fixed) pair%support_work = pair%support_work + 0.5_wp * model%drift * dot_product(both, a%v)
               if (b%fixed) pair%support_work = pair%support_work - 0.5_wp * model%drift * dot_product(both, b%v)
               point%force = force
               if (.not. point%closed) cycle
               call push_body(a, -force, at)
               call push_body(b, force, at)
            end associate
         end do
      end associate
   end subroutine apply_impulses

   !> Velocity of a body at a place, over the position step before [m/s]
   pure function velocity(b, at) result(v)
      type(body), intent(in) :: b
      real(wp), intent(in) :: at(3)                 !! [m]
      real(wp) :: v(3)
      real(wp) :: arm(3)
      arm = at - b%x
      v = b%v + cross(b%spin, arm)
   end function velocity

end module dem3_moreau
