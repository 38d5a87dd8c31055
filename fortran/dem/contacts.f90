!> Contact between two convex parts: along which edges they touch, and how deep.
!>
!> Two parts touch along a reference edge of one and an incident edge of the other: the reference
!> is the edge of least penetration (separating axis), the incident edge the one that faces it most
!> squarely, clipped to the reference edge. The two ends of what remains are the contact points,
!> so that a face on a face has exactly two, and a corner on a face one that is closed.
module dem_contacts
   use common_kinds, only : wp
   use dem_bodies, only : body, part, body_set, most_vertices
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: contact_point, contact_pair, contact_set, overlap, measure_overlap, measure_springs, choose_edges, pair_loss, &
      place_part

   !> What meets at a contact point: a corner of the incident part and the reference edge, or an end of the reference edge
   !> and the incident one
   integer, parameter :: unknown = -1, corner = 0, low_end = 1, high_end = 2

   !> Memory of one contact point
   type :: contact_point
      real(wp) :: length = 0.0_wp       !! of joint that it carries [m]
      real(wp) :: spring_n = 0.0_wp     !! elastic normal force, compression positive [N]
      real(wp) :: spring_s = 0.0_wp     !! elastic shear force on the incident body along the tangent [N]
      real(wp) :: dash_n = 0.0_wp       !! normal dashpot force [N]
      real(wp) :: dash_s = 0.0_wp       !! shear dashpot force [N]
      real(wp) :: friction_loss = 0.0_wp  !! [J]
      real(wp) :: damping_loss = 0.0_wp   !! [J]
      real(wp) :: slip(2) = 0.0_wp      !! on rigid contacts: sliding velocities of the last step and of the one before [m/s]
      real(wp) :: late = 0.0_wp         !! shear impulse that acts in the next step, see dem_rigid [N s]
      real(wp) :: crushed = 0.0_wp      !! by how much the corner has crushed [m]
      real(wp) :: filled = 0.0_wp       !! 0, or the negative gap at which the spring has no force [m]
      integer :: meets = unknown        !! what met here in the step before
      logical :: closed = .false.
      logical :: bonded = .false.       !! cohesion and tension not lost yet
   end type contact_point

   !> Two parts that are near. Body 1 owns the reference edge, body 2 the incident one.
   type :: contact_pair
      integer :: parts(2) = 0           !! reference part, incident part
      integer :: bodies(2) = 0
      integer :: edges(2) = 0
      integer :: law = 1
      integer :: joint = 0              !! of the two bodies in the law table, 0 where they had none at the start
      logical :: careful = .false.      !! the overlap is short: choose the edges anew in every step
      real(wp) :: rx = 0.0_wp, ry = 0.0_wp          !! start of the reference edge, in body 1 [m]
      real(wp) :: tx = 0.0_wp, ty = 0.0_wp          !! its tangent, in body 1
      real(wp) :: reference_length = 0.0_wp
      real(wp) :: incident_length = 0.0_wp
      real(wp) :: ax = 0.0_wp, ay = 0.0_wp          !! end of the incident edge, in body 2: low end [m]
      real(wp) :: bx = 0.0_wp, by = 0.0_wp          !! start of the incident edge: high end [m]
      real(wp) :: support_work = 0.0_wp             !! done by moving supports [J]
      real(wp) :: crushed = 0.0_wp                  !! energy that crushing corners hold, see dem_crushing [J]
      real(wp) :: loss_before(2) = 0.0_wp           !! friction, damping of contacts that are gone [J]
      !> Energy of springs that other edges do not take over: of shear ones times their stiffness k_s [J N/m^2], of normal
      !> ones over theirs, k_n [m^3]. Counted as losses in the next step
      real(wp) :: given_up(2) = 0.0_wp
      type(contact_point) :: point(2)
   end type contact_pair

   type :: contact_set
      integer :: pairs = 0
      type(contact_pair), allocatable :: pair(:)    !! by colour, then by the lower and the higher part
      type(contact_pair), allocatable :: spare(:)
      integer, allocatable :: row(:)                !! first entry of each lower part in the list of pairs
      integer, allocatable :: sequence(:)           !! that list: where each pair is, sorted by its parts
      integer :: colours = 0
      integer :: alone = 0                          !! 1 where the last colour must run on one thread
      integer, allocatable :: colour_first(:)       !! first pair of each colour; (colours + 1)
      integer, allocatable :: sweep(:)              !! parts by the left end of their boxes
      real(wp), allocatable :: box(:, :)            !! (4, parts): left, right, bottom, top
      integer(c_int64_t), allocatable :: used(:)    !! colours used at each body, as bits
      integer(c_int), allocatable :: law_first(:)   !! rows of the law table: first entry of each body
      integer(c_int), allocatable :: law_body(:)    !! the other body
      integer(c_int), allocatable :: law_number(:)
      real(wp), allocatable :: joint_loss(:, :)     !! (2, joints) by friction and dashpots of contacts that are gone [J]
      real(wp) :: skin = 0.0_wp                     !! [m]
      real(wp) :: friction_loss = 0.0_wp            !! of contacts that are gone [J]
      real(wp) :: damping_loss = 0.0_wp
      real(wp) :: support_work = 0.0_wp
   end type contact_set

   !> Where two parts face each other now. Each point has the direction of the edge that it slides on: a corner
   !> of the incident part on the reference edge, or an end of the reference edge on the incident one. Only so
   !> are normal forces conservative where an open joint slides.
   type :: overlap
      real(wp) :: tx(2), ty(2)          !! tangents; the normal (ty, -tx) points from body 1 to body 2
      real(wp) :: x(2), y(2)            !! contact points [m]
      real(wp) :: gap(2)                !! distances, negative where they overlap [m]
      real(wp) :: width                 !! of the common stretch [m]
      real(wp) :: elastic(2) = 1.0_wp   !! share of the springs where corners crush, see spring_share
      integer :: meets(2)               !! at each point
   end type overlap

contains

   !> Energy lost by friction and in dashpots, or by impacts, of a pair [J]
   pure function pair_loss(pair) result(lost)
      type(contact_pair), intent(in) :: pair
      real(wp) :: lost(2)
      lost = pair%loss_before + [sum(pair%point%friction_loss), sum(pair%point%damping_loss)]
   end function pair_loss

   !> Ends of the common stretch of reference and incident edge
   pure subroutine measure_overlap(pair, a, b, now, as)
      type(contact_pair), intent(in) :: pair
      type(body), intent(in) :: a           !! owner of the reference edge
      type(body), intent(in) :: b           !! owner of the incident edge
      type(overlap), intent(out) :: now
      integer, intent(in), optional :: as(2)    !! what meets at the points, known or not; else what meets there now
      real(wp) :: tx, ty, ox, oy, ix, iy, s(2), gap(2), length, run, rise
      integer :: i

      tx = a%c * pair%tx - a%s * pair%ty
      ty = a%s * pair%tx + a%c * pair%ty
      ox = a%x + a%c * pair%rx - a%s * pair%ry
      oy = a%y + a%s * pair%rx + a%c * pair%ry
      ix = b%x - ox + b%c * pair%ax - b%s * pair%ay
      iy = b%y - oy + b%s * pair%ax + b%c * pair%ay
      s(1) = ix * tx + iy * ty
      gap(1) = ix * ty - iy * tx
      ix = b%x - ox + b%c * pair%bx - b%s * pair%by
      iy = b%y - oy + b%s * pair%bx + b%c * pair%by
      s(2) = ix * tx + iy * ty
      gap(2) = ix * ty - iy * tx
      length = pair%incident_length
      run = max((s(2) - s(1)) / length, tiny(1.0_wp))
      rise = (gap(2) - gap(1)) / length
      do i = 1, 2
         now%meets(i) = corner
         if (s(i) < 0.0_wp) now%meets(i) = low_end
         if (s(i) > pair%reference_length) now%meets(i) = high_end
         if (present(as)) then
            if (as(i) /= unknown) now%meets(i) = as(i)
         end if
         if (now%meets(i) /= corner) then
            ! An end of the reference edge on the incident edge
            length = merge(0.0_wp, pair%reference_length, now%meets(i) == low_end)
            now%gap(i) = run * (gap(i) + (length - s(i)) * rise / run)
            now%tx(i) = run * tx + rise * ty
            now%ty(i) = run * ty - rise * tx
            s(i) = length
            now%x(i) = ox + s(i) * tx + 0.5_wp * now%gap(i) * now%ty(i)
            now%y(i) = oy + s(i) * ty - 0.5_wp * now%gap(i) * now%tx(i)
         else
            now%gap(i) = gap(i)
            now%tx(i) = tx
            now%ty(i) = ty
            now%x(i) = ox + s(i) * tx + 0.5_wp * gap(i) * ty
            now%y(i) = oy + s(i) * ty - 0.5_wp * gap(i) * tx
         end if
      end do
      now%width = s(2) - s(1)
   end subroutine measure_overlap

   !> The same with the gaps of the springs. A spring whose corner passes to another edge keeps its energy where it would
   !> gain, and the rest is a loss
   pure subroutine measure_springs(pair, a, b, now)
      type(contact_pair), intent(inout) :: pair
      type(body), intent(in) :: a           !! owner of the reference edge
      type(body), intent(in) :: b           !! owner of the incident edge
      type(overlap), intent(out) :: now
      integer :: i
      call measure_overlap(pair, a, b, now)
      if (now%meets(1) /= pair%point(1)%meets .or. now%meets(2) /= pair%point(2)%meets) call meet_others(pair, a, b, now)
      do i = 1, 2
         associate (point => pair%point(i))
            if (now%gap(i) >= 0.0_wp) then
               if (point%filled < 0.0_wp) point%filled = 0.0_wp
               cycle
            end if
            if (now%width <= 0.0_wp .and. .not. point%closed) point%filled = now%gap(i)
            now%gap(i) = now%gap(i) - point%filled
         end associate
      end do
   end subroutine measure_springs

   !> The springs whose corners meet another edge than in the step before pass to its gap
   pure subroutine meet_others(pair, a, b, now)
      type(contact_pair), intent(inout) :: pair
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(overlap), intent(in) :: now
      type(overlap) :: was
      integer :: i
      if (minval(now%gap) < 0.0_wp .or. any(pair%point%closed)) then
         call measure_overlap(pair, a, b, was, pair%point%meets)
         do i = 1, 2
            if (now%meets(i) == pair%point(i)%meets .or. pair%point(i)%meets == unknown) cycle
            call pass_on(pair%point(i), was%gap(i), now%gap(i), pair%given_up)
         end do
      end if
      pair%point%meets = now%meets
   end subroutine meet_others

   !> A spring passes from one gap to another. Its energy would grow with a deeper overlap: it keeps its force there, and
   !> the difference of the gaps has none. With a lesser overlap it loses energy
   pure subroutine pass_on(point, was, now, given_up)
      type(contact_point), intent(inout) :: point
      real(wp), intent(in) :: was               !! gap by what met before, at the present places [m]
      real(wp), intent(in) :: now               !! gap by what meets now [m]
      real(wp), intent(inout) :: given_up(2)    !! see contact_pair
      real(wp) :: pressed, presses, crushed, remains
      if (point%bonded) return
      pressed = min(was - point%filled, 0.0_wp)
      if (.not. point%closed) pressed = 0.0_wp
      presses = max(pressed, min(now, 0.0_wp))
      point%filled = min(now, 0.0_wp) - presses
      ! What has crushed at a constant force comes back first
      crushed = min(point%crushed, -pressed)
      remains = max(crushed - (presses - pressed), 0.0_wp)
      given_up(2) = given_up(2) + 0.5_wp * point%length * (pressed**2 - crushed**2 - presses**2 + remains**2)
   end subroutine pass_on

   !> Energy of the normal spring of a closed point over its stiffness k_n, with that of a corner that crushes: of an overlap d of which
   !> c has crushed, l [(d - c)^2 / 2 + (d - c) c] [m^3]
   pure function held_energy(point, gap) result(energy)
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: gap               !! [m]
      real(wp) :: energy
      real(wp) :: drawn
      drawn = gap - point%filled
      if (.not. point%bonded) drawn = min(drawn, 0.0_wp)
      energy = 0.5_wp * point%length * max(drawn**2 - point%crushed**2, 0.0_wp)
   end function held_energy

   !> Vertices of a part where they are now
   pure subroutine place_part(set, p, x, n)
      type(body_set), intent(in) :: set
      integer, intent(in) :: p
      real(wp), intent(out) :: x(2, most_vertices)   !! [m]
      integer, intent(out) :: n
      integer :: k
      associate (owner => set%item(set%parts(p)%owner))
         n = set%parts(p)%last - set%parts(p)%first + 1
         do k = 1, n
            associate (e => set%edges(set%parts(p)%first + k - 1))
               x(1, k) = owner%x + owner%c * e%x - owner%s * e%y
               x(2, k) = owner%y + owner%s * e%x + owner%c * e%y
            end associate
         end do
      end associate
   end subroutine place_part

   !> Distance of the nearest vertex of another part in front of one edge
   pure function clearance(set, p, k, x, n) result(distance)
      type(body_set), intent(in) :: set
      integer, intent(in) :: p               !! part of the edge
      integer, intent(in) :: k               !! edge
      real(wp), intent(in) :: x(2, most_vertices)   !! vertices of the other part [m]
      integer, intent(in) :: n
      real(wp) :: distance
      real(wp) :: nx, ny, ox, oy
      integer :: i
      associate (owner => set%item(set%parts(p)%owner), e => set%edges(k))
         nx = owner%c * e%ty + owner%s * e%tx
         ny = owner%s * e%ty - owner%c * e%tx
         ox = owner%x + owner%c * e%x - owner%s * e%y
         oy = owner%y + owner%s * e%x + owner%c * e%y
      end associate
      distance = (x(1, 1) - ox) * nx + (x(2, 1) - oy) * ny
      do i = 2, n
         distance = min(distance, (x(1, i) - ox) * nx + (x(2, i) - oy) * ny)
      end do
   end function clearance

   !> The outer edge of part p that has the other part farthest in front of it
   pure subroutine best_edge(set, p, x, n, k_best, distance)
      type(body_set), intent(in) :: set
      integer, intent(in) :: p
      real(wp), intent(in) :: x(2, most_vertices)
      integer, intent(in) :: n
      integer, intent(out) :: k_best
      real(wp), intent(out) :: distance
      integer :: k
      real(wp) :: d
      distance = -huge(1.0_wp)
      k_best = 0
      do k = set%parts(p)%first, set%parts(p)%last
         if (.not. set%edges(k)%outer) cycle
         d = clearance(set, p, k, x, n)
         if (d > distance) then
            distance = d
            k_best = k
         end if
      end do
   end subroutine best_edge

   !> Choose reference and incident edge of a pair; what it had is kept unless another is clearly better
   pure subroutine choose_edges(set, skin, pair, distance)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: skin                  !! [m]
      type(contact_pair), intent(inout) :: pair
      real(wp), intent(out) :: distance             !! between the parts, negative where they overlap [m]
      real(wp) :: x1(2, most_vertices), x2(2, most_vertices), d1, d2, had_distance, slack
      integer :: n1, n2, k1, k2
      logical :: is_new, keep, swap
      type(contact_pair) :: had

      had = pair
      is_new = had%edges(1) == 0
      slack = 0.05_wp * skin
      call place_part(set, pair%parts(1), x1, n1)
      call place_part(set, pair%parts(2), x2, n2)
      call best_edge(set, pair%parts(1), x2, n2, k1, d1)
      call best_edge(set, pair%parts(2), x1, n1, k2, d2)
      distance = max(d1, d2)
      keep = .false.
      swap = d2 > d1
      if (.not. is_new) then
         had_distance = clearance(set, pair%parts(1), had%edges(1), x2, n2)
         keep = had_distance >= distance - slack
         if (keep) distance = had_distance
      else if (abs(d1 - d2) <= slack) then
         swap = set%edges(k2)%length > set%edges(k1)%length
      end if
      if (keep) then
         call choose_face(set, skin, pair, .true.)
      else if (swap) then
         pair%parts = had%parts([2, 1])
         pair%bodies = had%bodies([2, 1])
         pair%edges = [k2, 0]
         call choose_face(set, skin, pair, .false.)
      else
         pair%edges(1) = k1
         call choose_face(set, skin, pair, .false.)
      end if
      if (.not. is_new .and. any(pair%edges /= had%edges)) call carry_over(set, had, pair)
   end subroutine choose_edges

   !> The incident edge: of the two that meet at the vertex nearest to the reference edge (or beyond it), the one
   !> that faces it more squarely, provided that it lies before it: at a hinge on two corners the other one
   !> leads outward, where nothing touches
   pure subroutine choose_face(set, skin, pair, keep)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: skin          !! [m]
      type(contact_pair), intent(inout) :: pair
      logical, intent(in) :: keep           !! the reference edge is the one it had
      integer :: k, nearest, before, had
      real(wp) :: c, s, tx, ty, ox, oy, d, least

      associate (a => set%item(pair%bodies(1)), b => set%item(pair%bodies(2)), e => set%edges(pair%edges(1)))
         ! Reference edge in the frame of the incident body
         c = b%c * a%c + b%s * a%s
         s = b%c * a%s - b%s * a%c
         tx = c * e%tx - s * e%ty
         ty = s * e%tx + c * e%ty
         ox = b%c * (a%x - b%x) + b%s * (a%y - b%y) + c * e%x - s * e%y
         oy = b%c * (a%y - b%y) - b%s * (a%x - b%x) + s * e%x + c * e%y
      end associate
      least = huge(1.0_wp)
      nearest = 0
      do k = set%parts(pair%parts(2))%first, set%parts(pair%parts(2))%last
         d = (set%edges(k)%x - ox) * ty - (set%edges(k)%y - oy) * tx
         if (d < least) then
            least = d
            nearest = k
         end if
      end do
      before = nearest - 1
      if (before < set%parts(pair%parts(2))%first) before = set%parts(pair%parts(2))%last
      had = pair%edges(2)
      pair%edges(2) = merge(before, nearest, merit(before) > merit(nearest))
      if (keep .and. (had == before .or. had == nearest)) then
         if (merit(had) > merit(pair%edges(2)) - 0.02_wp) pair%edges(2) = had
      end if
      call take_edges(set, pair)

   contains

      !> How squarely an edge faces the reference edge, less where their common stretch is short
      pure function merit(edge_number) result(m)
         integer, intent(in) :: edge_number
         real(wp) :: m
         real(wp) :: one, two, width, whole
         associate (i => set%edges(edge_number))
            one = (i%x - ox) * tx + (i%y - oy) * ty
            two = (set%edges(i%next)%x - ox) * tx + (set%edges(i%next)%y - oy) * ty
            whole = min(4.0_wp * skin, 0.5_wp * set%edges(pair%edges(1))%length, 0.5_wp * i%length)
            width = min(set%edges(pair%edges(1))%length, max(one, two)) - max(0.0_wp, min(one, two))
            m = -(i%tx * tx + i%ty * ty) * min(1.0_wp, max(width, 0.0_wp) / whole)
         end associate
      end function merit

   end subroutine choose_face

   !> Copy the geometry of the chosen edges into the pair
   pure subroutine take_edges(set, pair)
      type(body_set), intent(in) :: set
      type(contact_pair), intent(inout) :: pair
      associate (r => set%edges(pair%edges(1)), i => set%edges(pair%edges(2)))
         pair%rx = r%x
         pair%ry = r%y
         pair%tx = r%tx
         pair%ty = r%ty
         pair%reference_length = r%length
         pair%incident_length = i%length
         pair%ax = set%edges(i%next)%x
         pair%ay = set%edges(i%next)%y
         pair%bx = i%x
         pair%by = i%y
      end associate
   end subroutine take_edges

   !> Hand the memory of contact points to the new edges: each new point takes the nearest old one.
   !> Forces keep their sense when the roles swap, since tangent and acting body both turn round. A new point that takes
   !> none begins without force, however deep the overlap, unless mortar binds the pair: with its force at once the springs would gain
   !> energy. Points of rigid contacts carry no length and hold no energy.
   pure subroutine carry_over(set, old, new)
      type(body_set), intent(in) :: set
      type(contact_pair), intent(in) :: old
      type(contact_pair), intent(inout) :: new
      type(overlap) :: was, now
      real(wp) :: distance(2, 2), reach
      integer :: i, j
      type(contact_point) :: memory(2)
      logical :: taken(2)

      call measure_overlap(old, set%item(old%bodies(1)), set%item(old%bodies(2)), was, old%point%meets)
      call measure_overlap(new, set%item(new%bodies(1)), set%item(new%bodies(2)), now)
      memory = old%point
      reach = 0.1_wp * min(old%reference_length, old%incident_length)
      do i = 1, 2
         do j = 1, 2
            distance(i, j) = hypot(now%x(i) - was%x(j), now%y(i) - was%y(j))
         end do
      end do
      taken = .false.
      new%point = contact_point()
      if (.not. any(memory%bonded)) new%point%filled = min(now%gap, 0.0_wp)
      do i = 1, 2
         j = merge(1, 2, distance(i, 1) <= distance(i, 2))
         if (distance(i, j) > reach .or. taken(j)) cycle
         if (distance(3 - i, j) < distance(i, j)) cycle
         new%point(i) = memory(j)
         taken(j) = .true.
         call pass_on(new%point(i), was%gap(j), now%gap(i), new%given_up)
      end do
      new%point%meets = now%meets
      do j = 1, 2
         if (taken(j)) cycle
         if (memory(j)%closed .and. memory(j)%length > 0.0_wp) new%given_up = new%given_up &
            + [0.5_wp * memory(j)%spring_s**2 / memory(j)%length, held_energy(memory(j), was%gap(j))]
         new%loss_before = new%loss_before + [memory(j)%friction_loss, memory(j)%damping_loss]
      end do
   end subroutine carry_over

end module dem_contacts
