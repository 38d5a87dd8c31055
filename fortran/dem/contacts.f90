!> Contact search between convex parts: who is near whom, along which edges, and how deep.
!>
!> Two parts touch along a reference edge of one and an incident edge of the other: the reference
!> is the edge of least penetration (separating axis), the incident edge the one that faces it most
!> squarely, clipped to the reference edge. The two ends of what remains are the contact points,
!> so that a face on a face has exactly two, and a corner on a face one that is closed.
module dem_contacts
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_bodies, only : body, part, body_set, most_vertices
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: contact_point, contact_pair, contact_set, overlap, search, measure, choose_edges

   !> Memory of one contact point
   type :: contact_point
      real(wp) :: length = 0.0_wp       !! of joint that it carries [m]
      real(wp) :: spring_n = 0.0_wp     !! elastic normal force, compression positive [N]
      real(wp) :: spring_s = 0.0_wp     !! elastic shear force on the incident body along the tangent [N]
      real(wp) :: dash_n = 0.0_wp       !! normal dashpot force [N]
      real(wp) :: dash_s = 0.0_wp       !! shear dashpot force [N]
      real(wp) :: friction_loss = 0.0_wp  !! [J]
      real(wp) :: damping_loss = 0.0_wp   !! [J]
      logical :: closed = .false.
      logical :: bonded = .false.       !! cohesion and tension not lost yet
   end type contact_point

   !> Two parts that are near. Body 1 owns the reference edge, body 2 the incident one.
   type :: contact_pair
      integer :: parts(2) = 0           !! reference part, incident part
      integer :: bodies(2) = 0
      integer :: edges(2) = 0
      integer :: law = 1
      logical :: careful = .false.      !! the overlap is short: choose the edges anew in every step
      real(wp) :: rx = 0.0_wp, ry = 0.0_wp          !! start of the reference edge, in body 1 [m]
      real(wp) :: tx = 0.0_wp, ty = 0.0_wp          !! its tangent, in body 1
      real(wp) :: reference_length = 0.0_wp
      real(wp) :: incident_length = 0.0_wp
      real(wp) :: ax = 0.0_wp, ay = 0.0_wp          !! end of the incident edge, in body 2: low end [m]
      real(wp) :: bx = 0.0_wp, by = 0.0_wp          !! start of the incident edge: high end [m]
      real(wp) :: support_work = 0.0_wp             !! done by moving supports [J]
      real(wp) :: loss_before(2) = 0.0_wp           !! friction, damping of contacts that are gone [J]
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
   end type overlap

   integer, parameter :: most_colours = 62

contains

   !> Ends of the common stretch of reference and incident edge
   pure subroutine measure(it, a, b, now)
      type(contact_pair), intent(in) :: it
      type(body), intent(in) :: a           !! owner of the reference edge
      type(body), intent(in) :: b           !! owner of the incident edge
      type(overlap), intent(out) :: now
      real(wp) :: tx, ty, ox, oy, ix, iy, s(2), gap(2), length, run, rise
      integer :: i

      tx = a%c * it%tx - a%s * it%ty
      ty = a%s * it%tx + a%c * it%ty
      ox = a%x + a%c * it%rx - a%s * it%ry
      oy = a%y + a%s * it%rx + a%c * it%ry
      ix = b%x - ox + b%c * it%ax - b%s * it%ay
      iy = b%y - oy + b%s * it%ax + b%c * it%ay
      s(1) = ix * tx + iy * ty
      gap(1) = ix * ty - iy * tx
      ix = b%x - ox + b%c * it%bx - b%s * it%by
      iy = b%y - oy + b%s * it%bx + b%c * it%by
      s(2) = ix * tx + iy * ty
      gap(2) = ix * ty - iy * tx
      length = it%incident_length
      run = max((s(2) - s(1)) / length, tiny(1.0_wp))
      rise = (gap(2) - gap(1)) / length
      do i = 1, 2
         if (s(i) < 0.0_wp .or. s(i) > it%reference_length) then
            ! An end of the reference edge on the incident edge
            length = merge(0.0_wp, it%reference_length, s(i) < 0.0_wp)
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
   end subroutine measure

   !> Vertices of a part where they are now
   pure subroutine place(set, p, x, n)
      type(body_set), intent(in) :: set
      integer, intent(in) :: p
      real(wp), intent(out) :: x(2, most_vertices)   !! [m]
      integer, intent(out) :: n
      integer :: k
      associate (it => set%item(set%parts(p)%owner))
         n = set%parts(p)%last - set%parts(p)%first + 1
         do k = 1, n
            associate (e => set%edges(set%parts(p)%first + k - 1))
               x(1, k) = it%x + it%c * e%x - it%s * e%y
               x(2, k) = it%y + it%s * e%x + it%c * e%y
            end associate
         end do
      end associate
   end subroutine place

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
      associate (it => set%item(set%parts(p)%owner), e => set%edges(k))
         nx = it%c * e%ty + it%s * e%tx
         ny = it%s * e%ty - it%c * e%tx
         ox = it%x + it%c * e%x - it%s * e%y
         oy = it%y + it%s * e%x + it%c * e%y
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
   pure subroutine choose_edges(set, skin, it, distance)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: skin                  !! [m]
      type(contact_pair), intent(inout) :: it
      real(wp), intent(out) :: distance             !! between the parts, negative where they overlap [m]
      real(wp) :: x1(2, most_vertices), x2(2, most_vertices), d1, d2, had_distance, slack
      integer :: n1, n2, k1, k2
      logical :: is_new, keep, swap
      type(contact_pair) :: had

      had = it
      is_new = had%edges(1) == 0
      slack = 0.05_wp * skin
      call place(set, it%parts(1), x1, n1)
      call place(set, it%parts(2), x2, n2)
      call best_edge(set, it%parts(1), x2, n2, k1, d1)
      call best_edge(set, it%parts(2), x1, n1, k2, d2)
      distance = max(d1, d2)
      keep = .false.
      swap = d2 > d1
      if (.not. is_new) then
         had_distance = clearance(set, it%parts(1), had%edges(1), x2, n2)
         keep = had_distance >= distance - slack
         if (keep) distance = had_distance
      else if (abs(d1 - d2) <= slack) then
         swap = set%edges(k2)%length > set%edges(k1)%length
      end if
      if (keep) then
         call face(set, skin, it, .true.)
      else if (swap) then
         it%parts = had%parts([2, 1])
         it%bodies = had%bodies([2, 1])
         it%edges = [k2, 0]
         call face(set, skin, it, .false.)
      else
         it%edges(1) = k1
         call face(set, skin, it, .false.)
      end if
      if (.not. is_new .and. any(it%edges /= had%edges)) call carry_over(set, had, it)
   end subroutine choose_edges

   !> The incident edge: of the two that meet at the vertex nearest to the reference edge (or beyond it), the one
   !> that faces it more squarely, provided that it lies before it: at a hinge on two corners the other one
   !> leads outward, where nothing touches
   pure subroutine face(set, skin, it, keep)
      type(body_set), intent(in) :: set
      real(wp), intent(in) :: skin          !! [m]
      type(contact_pair), intent(inout) :: it
      logical, intent(in) :: keep           !! the reference edge is the one it had
      integer :: k, nearest, before, had
      real(wp) :: c, s, tx, ty, ox, oy, d, least

      associate (a => set%item(it%bodies(1)), b => set%item(it%bodies(2)), e => set%edges(it%edges(1)))
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
      do k = set%parts(it%parts(2))%first, set%parts(it%parts(2))%last
         d = (set%edges(k)%x - ox) * ty - (set%edges(k)%y - oy) * tx
         if (d < least) then
            least = d
            nearest = k
         end if
      end do
      before = nearest - 1
      if (before < set%parts(it%parts(2))%first) before = set%parts(it%parts(2))%last
      had = it%edges(2)
      it%edges(2) = merge(before, nearest, merit(before) > merit(nearest))
      if (keep .and. (had == before .or. had == nearest)) then
         if (merit(had) > merit(it%edges(2)) - 0.02_wp) it%edges(2) = had
      end if
      call take_edges(set, it)

   contains

      !> How squarely an edge faces the reference edge, less where their common stretch is short
      pure function merit(edge_number) result(m)
         integer, intent(in) :: edge_number
         real(wp) :: m
         real(wp) :: one, two, width, whole
         associate (i => set%edges(edge_number))
            one = (i%x - ox) * tx + (i%y - oy) * ty
            two = (set%edges(i%next)%x - ox) * tx + (set%edges(i%next)%y - oy) * ty
            whole = min(4.0_wp * skin, 0.5_wp * set%edges(it%edges(1))%length, 0.5_wp * i%length)
            width = min(set%edges(it%edges(1))%length, max(one, two)) - max(0.0_wp, min(one, two))
            m = -(i%tx * tx + i%ty * ty) * min(1.0_wp, max(width, 0.0_wp) / whole)
         end associate
      end function merit

   end subroutine face

   !> Copy the geometry of the chosen edges into the pair
   pure subroutine take_edges(set, it)
      type(body_set), intent(in) :: set
      type(contact_pair), intent(inout) :: it
      associate (r => set%edges(it%edges(1)), i => set%edges(it%edges(2)))
         it%rx = r%x
         it%ry = r%y
         it%tx = r%tx
         it%ty = r%ty
         it%reference_length = r%length
         it%incident_length = i%length
         it%ax = set%edges(i%next)%x
         it%ay = set%edges(i%next)%y
         it%bx = i%x
         it%by = i%y
      end associate
   end subroutine take_edges

   !> Hand the memory of contact points to the new edges: each new point takes the nearest old one.
   !> Forces keep their sense when the roles swap, since tangent and acting body both turn round.
   pure subroutine carry_over(set, old, new)
      type(body_set), intent(in) :: set
      type(contact_pair), intent(in) :: old
      type(contact_pair), intent(inout) :: new
      type(overlap) :: was, now
      real(wp) :: distance(2, 2), reach
      integer :: i, j
      type(contact_point) :: memory(2)
      logical :: taken(2)

      call measure(old, set%item(old%bodies(1)), set%item(old%bodies(2)), was)
      call measure(new, set%item(new%bodies(1)), set%item(new%bodies(2)), now)
      memory = old%point
      reach = 0.1_wp * min(old%reference_length, old%incident_length)
      do i = 1, 2
         do j = 1, 2
            distance(i, j) = hypot(now%x(i) - was%x(j), now%y(i) - was%y(j))
         end do
      end do
      taken = .false.
      new%point = contact_point()
      do i = 1, 2
         j = merge(1, 2, distance(i, 1) <= distance(i, 2))
         if (distance(i, j) > reach .or. taken(j)) cycle
         if (distance(3 - i, j) < distance(i, j)) cycle
         new%point(i) = memory(j)
         taken(j) = .true.
      end do
      do j = 1, 2
         if (taken(j)) cycle
         new%loss_before = new%loss_before + [memory(j)%friction_loss, memory(j)%damping_loss]
      end do
   end subroutine carry_over

   !> Rebuild the list of near pairs; persistent ones keep their memory
   subroutine search(set, contacts, first_time, status)
      type(body_set), intent(inout) :: set
      type(contact_set), intent(inout) :: contacts
      logical, intent(in) :: first_time           !! contacts found now may carry a bond
      integer(c_int), intent(out) :: status
      integer :: n, i, j, p, q, k, found, failed

      n = size(set%parts)
      status = status_out_of_memory
      if (first_time) then
         allocate (contacts%pair(8 * n), contacts%spare(8 * n), contacts%row(n + 1), contacts%sequence(8 * n), &
            contacts%sweep(n), contacts%box(4, n), contacts%used(size(set%item)), &
            contacts%colour_first(most_colours + 3), stat=failed)
         if (failed /= 0) return
         do i = 1, n
            contacts%sweep(i) = i
         end do
         contacts%row = 1
      end if
      call boxes(set, contacts)
      call sort_boxes(contacts)
      found = 0
      do i = 1, n
         p = contacts%sweep(i)
         do j = i + 1, n
            q = contacts%sweep(j)
            if (contacts%box(1, q) > contacts%box(2, p)) exit
            if (contacts%box(3, q) > contacts%box(4, p) .or. contacts%box(3, p) > contacts%box(4, q)) cycle
            if (set%parts(p)%owner == set%parts(q)%owner) cycle
            if (set%item(set%parts(p)%owner)%fixed .and. set%item(set%parts(q)%owner)%fixed) cycle
            if (found == size(contacts%spare)) then
               call grow(contacts, failed)
               if (failed /= 0) return
            end if
            call consider(set, contacts, min(p, q), max(p, q), first_time, contacts%spare(found + 1), k)
            found = found + k
         end do
      end do
      call keep(set, contacts, found, failed)
      if (failed /= 0) return
      call colour(set, contacts)
      set%item%seen_x = set%item%x
      set%item%seen_y = set%item%y
      set%item%seen_angle = set%item%angle
      status = status_ok
   end subroutine search

   !> Boxes of all parts, wider by half the skin
   pure subroutine boxes(set, contacts)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      real(wp) :: x(2, most_vertices)
      integer :: p, n
      do p = 1, size(set%parts)
         call place(set, p, x, n)
         contacts%box(1, p) = minval(x(1, 1:n)) - 0.5_wp * contacts%skin
         contacts%box(2, p) = maxval(x(1, 1:n)) + 0.5_wp * contacts%skin
         contacts%box(3, p) = minval(x(2, 1:n)) - 0.5_wp * contacts%skin
         contacts%box(4, p) = maxval(x(2, 1:n)) + 0.5_wp * contacts%skin
      end do
   end subroutine boxes

   !> Insertion sort by the left ends: the order of the last search is nearly right
   pure subroutine sort_boxes(contacts)
      type(contact_set), intent(inout) :: contacts
      integer :: i, j, p
      do i = 2, size(contacts%sweep)
         p = contacts%sweep(i)
         j = i - 1
         do while (j >= 1)
            if (contacts%box(1, contacts%sweep(j)) <= contacts%box(1, p)) exit
            contacts%sweep(j + 1) = contacts%sweep(j)
            j = j - 1
         end do
         contacts%sweep(j + 1) = p
      end do
   end subroutine sort_boxes

   !> Twice the room for pairs
   subroutine grow(contacts, failed)
      type(contact_set), intent(inout) :: contacts
      integer, intent(out) :: failed
      type(contact_pair), allocatable :: bigger(:)
      integer, allocatable :: longer(:)
      integer :: n
      n = 2 * size(contacts%spare)
      allocate (bigger(n), stat=failed)
      if (failed /= 0) return
      bigger(1:size(contacts%spare)) = contacts%spare
      call move_alloc(bigger, contacts%spare)
      allocate (longer(n), stat=failed)
      if (failed /= 0) return
      longer(1:size(contacts%sequence)) = contacts%sequence
      call move_alloc(longer, contacts%sequence)
   end subroutine grow

   !> Write the pair of parts p < q where they are within the skin; took is 1 then, else 0
   subroutine consider(set, contacts, p, q, first_time, it, took)
      type(body_set), intent(in) :: set
      type(contact_set), intent(in) :: contacts
      integer, intent(in) :: p
      integer, intent(in) :: q
      logical, intent(in) :: first_time
      type(contact_pair), intent(out) :: it
      integer, intent(out) :: took
      integer :: k
      real(wp) :: distance
      type(overlap) :: now

      if (.not. first_time) then
         do k = contacts%row(p), contacts%row(p + 1) - 1
            if (maxval(contacts%pair(contacts%sequence(k))%parts) == q) it = contacts%pair(contacts%sequence(k))
         end do
      end if
      if (it%parts(1) == 0) then
         it%parts = [p, q]
         it%bodies = [set%parts(p)%owner, set%parts(q)%owner]
         it%law = law_of(contacts, it%bodies(1), it%bodies(2))
      end if
      call choose_edges(set, contacts%skin, it, distance)
      took = merge(1, 0, distance <= contacts%skin)
      if (took == 0) return
      call measure(it, set%item(it%bodies(1)), set%item(it%bodies(2)), now)
      it%careful = now%width < 2.0_wp * contacts%skin
      if (first_time) it%point%bonded = .not. it%careful .and. now%gap <= 0.05_wp * contacts%skin
   end subroutine consider

   !> Law of the joint between two bodies: from the table, or the first one
   pure function law_of(contacts, a, b) result(law)
      type(contact_set), intent(in) :: contacts
      integer, intent(in) :: a
      integer, intent(in) :: b
      integer :: law
      integer :: k
      law = 1
      do k = contacts%law_first(min(a, b)), contacts%law_first(min(a, b) + 1) - 1
         if (contacts%law_body(k) == max(a, b)) law = contacts%law_number(k)
      end do
   end function law_of

   !> Sort the pairs found by their parts and remember what the vanished ones have lost
   subroutine keep(set, contacts, found, failed)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      integer, intent(in) :: found
      integer, intent(out) :: failed
      integer :: i, j, k, p
      type(contact_pair) :: it
      integer, allocatable :: fill(:)
      real(wp) :: total(3)

      failed = 0
      total = losses(contacts%pair, contacts%pairs)
      contacts%friction_loss = contacts%friction_loss + total(1)
      contacts%damping_loss = contacts%damping_loss + total(2)
      contacts%support_work = contacts%support_work + total(3)
      if (size(contacts%pair) < size(contacts%spare)) then
         deallocate (contacts%pair)
         allocate (contacts%pair(size(contacts%spare)), stat=failed)
         if (failed /= 0) return
      end if
      allocate (fill(size(set%parts) + 1), stat=failed)
      if (failed /= 0) return
      fill = 0
      do k = 1, found
         p = minval(contacts%spare(k)%parts)
         fill(p) = fill(p) + 1
      end do
      contacts%row(1) = 1
      do p = 1, size(set%parts)
         contacts%row(p + 1) = contacts%row(p) + fill(p)
      end do
      fill(1:size(set%parts)) = contacts%row(1:size(set%parts))
      do k = 1, found
         p = minval(contacts%spare(k)%parts)
         contacts%pair(fill(p)) = contacts%spare(k)
         fill(p) = fill(p) + 1
      end do
      do p = 1, size(set%parts)
         do i = contacts%row(p) + 1, contacts%row(p + 1) - 1
            it = contacts%pair(i)
            j = i - 1
            do while (j >= contacts%row(p))
               if (maxval(contacts%pair(j)%parts) <= maxval(it%parts)) exit
               contacts%pair(j + 1) = contacts%pair(j)
               j = j - 1
            end do
            contacts%pair(j + 1) = it
         end do
      end do
      contacts%pairs = found
      total = losses(contacts%pair, found)
      contacts%friction_loss = contacts%friction_loss - total(1)
      contacts%damping_loss = contacts%damping_loss - total(2)
      contacts%support_work = contacts%support_work - total(3)
   end subroutine keep

   !> Friction loss, damping loss and support work remembered by the pairs [J]
   pure function losses(pair, n) result(total)
      type(contact_pair), intent(in) :: pair(:)
      integer, intent(in) :: n
      real(wp) :: total(3)
      integer :: k
      total = 0.0_wp
      do k = 1, n
         total(1) = total(1) + pair(k)%loss_before(1) + sum(pair(k)%point%friction_loss)
         total(2) = total(2) + pair(k)%loss_before(2) + sum(pair(k)%point%damping_loss)
         total(3) = total(3) + pair(k)%support_work
      end do
   end function losses

   !> Colours such that two pairs of one colour share no mobile body: a colour may run in parallel,
   !> and the result is that of one thread bit for bit. Pairs beyond the last
   !> colour run one by one.
   subroutine colour(set, contacts)
      type(body_set), intent(in) :: set
      type(contact_set), intent(inout) :: contacts
      integer :: k, c, i, b, count(most_colours + 1)
      integer(c_int64_t) :: bits

      contacts%used = 0_c_int64_t
      count = 0
      contacts%sequence(1:contacts%pairs) = 0
      do k = 1, contacts%pairs
         bits = 0_c_int64_t
         do i = 1, 2
            b = contacts%pair(k)%bodies(i)
            if (.not. set%item(b)%fixed) bits = ior(bits, contacts%used(b))
         end do
         c = 0
         do while (c < most_colours .and. btest(bits, c))
            c = c + 1
         end do
         do i = 1, 2
            b = contacts%pair(k)%bodies(i)
            if (c < most_colours) contacts%used(b) = ibset(contacts%used(b), c)
         end do
         contacts%sequence(k) = c + 1
         count(c + 1) = count(c + 1) + 1
      end do
      contacts%colour_first(1) = 1
      do c = 1, most_colours + 1
         contacts%colour_first(c + 1) = contacts%colour_first(c) + count(c)
      end do
      contacts%colours = most_colours + 1
      do while (contacts%colours > 0)
         if (count(contacts%colours) > 0) exit
         contacts%colours = contacts%colours - 1
      end do
      contacts%alone = merge(1, 0, contacts%colours > most_colours)
      ! Pairs of one colour lie side by side: a sweep reads them in order.
      count = contacts%colour_first(1:most_colours + 1)
      do k = 1, contacts%pairs
         c = contacts%sequence(k)
         contacts%sequence(k) = count(c)
         contacts%spare(count(c)) = contacts%pair(k)
         count(c) = count(c) + 1
      end do
      contacts%pair(1:contacts%pairs) = contacts%spare(1:contacts%pairs)
   end subroutine colour

end module dem_contacts
