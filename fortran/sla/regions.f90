!> Which parts of the structure an event can matter to.
!>
!> The elimination tree of the factor cuts the equations into regions; all that hangs below a region is bound to the
!> rest by the equations of its edge alone. As long as no event happens in it, its displacements follow those of the
!> edge by backward substitution, which is linear: it may wait for many events and be made up for at once.
!>
!> What the stresses can have done meanwhile is bounded by the strain energy U that the motion of the edge brings in.
!> Of all displacements with the same edge the true ones have the least energy. So sqrt(2 U) is at most that of a
!> quadratic polynomial fitted to the edge, plus that of what is left over at the edge alone (Dirichlet's
!> principle, triangle inequality), both with the undamaged stiffness, which no damage exceeds. A component of the
!> stress at a point of volume w and stiffness D then changes by at most sqrt(2 U D / w): see `margin` of the groups.
module sla_regions
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory, status_library_failed
   use sla_c_bindings, only : extrados_sparse_tree, extrados_sparse_backward
   use sla_group, only : group_holder, point_group, most_entries
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_int, c_int64_t, c_ptr
   implicit none
   private
   public :: region, region_tree, regions_new, regions_measure, regions_settled, regions_bring, regions_made_up
   public :: regions_window, regions_calm, regions_margins, regions_home, levels

   !> Multipliers at which margins are kept
   integer, parameter :: levels = 10
   !> Equations of a region at the tips of the tree
   integer, parameter :: tip_size = 160
   !> Events that a region is looked at without asking, at most
   integer, parameter :: most_patience = 15
   !> Monomials of a quadratic polynomial of x and y, and z; freedoms of a node
   integer, parameter :: most_terms = 10, most_directions = 6

   type :: region
      integer(c_int64_t) :: first_block = 0, last_block = 0   !! supernodes, 0-based
      integer :: first = 0, last = 0                !! equations
      integer :: lowest = 0                         !! first region of the subtree below
      integer :: parent = 0                         !! 0 none
      integer :: edge = 0, edges = 0                !! entries edge + 1 to edge + edges
      integer :: run = 0, runs = 0                  !! elements
      real(wp) :: centre(3) = 0.0_wp                !! of the polynomial
      real(wp) :: size = 1.0_wp
      !> (terms, polynomials) of the monomials, orthonormal over the weighted equations of one direction each
      real(wp), allocatable :: fit(:, :)
      integer, allocatable :: of(:)                 !! (polynomials) their directions
      real(wp), allocatable :: energy(:, :)         !! of the polynomials [N/m], [N m]
      real(wp) :: stiffest = 0.0_wp                 !! greatest entry of it
      real(wp) :: margin(levels) = -1.0_wp          !! of all points below, see point_group [J^1/2]
      real(wp) :: moved(6) = 0.0_wp                 !! energies of the edge's motion, see `reach`
      integer :: patience = 0                       !! events to go without asking
      integer :: failed = 0                         !! times asked in vain, one after the other
      integer :: seen = 0                           !! event at which it was brought up to date
   end type region

   type :: region_tree
      type(region), allocatable :: part(:)          !! children before their parents
      integer, allocatable :: of(:)                 !! (n) region of an equation
      integer, allocatable :: edge(:)               !! equations
      real(wp), allocatable :: kept(:, :)           !! (2, edge) displacements when the region was last brought
      integer, allocatable :: run(:, :)             !! (3, runs) group, first and last element
      integer :: terms = 6                          !! monomials: 6 in the plane, 10 in space
      integer :: directions = 2                     !! freedoms of a node
      real(wp), allocatable :: place(:, :)          !! (axes, n) where an equation acts, over the size of the whole
      real(wp), allocatable :: share(:)             !! (n) its displacement per unit one of the node there, 0 unknown
      integer, allocatable :: direction(:)          !! (n) which freedom of its node
      real(wp), allocatable :: weight(:)            !! (n) bound of the stiffness [N/m], [N m]
      real(wp) :: lambda(levels) = 0.0_wp           !! ascending
      logical :: measured = .false.                 !! the polynomials are there
      logical :: settled = .false.                  !! margins and edges are kept; else all is looked at
      integer :: now = 0                            !! counts the events
   end type region_tree

contains

   !> Cut the tree of a factor; the elements in the regions where they are eliminated
   subroutine regions_new(tree, handle, holders, n, status)
      type(region_tree), intent(out) :: tree
      type(c_ptr), intent(in) :: handle
      type(group_holder), intent(in) :: holders(:)
      integer, intent(in) :: n                       !! equations
      integer(c_int), intent(out) :: status
      type(c_ptr) :: address(3)
      integer(c_int64_t) :: blocks
      integer(c_int64_t), pointer :: column(:), start(:), row(:)
      integer, allocatable :: block_of(:), above(:), below(:), children(:), lowest(:), number(:), count(:)
      integer :: b, k, i, edges, info

      call extrados_sparse_tree(handle, blocks, address(1), address(2), address(3))
      call c_f_pointer(address(1), column, [blocks + 1])
      call c_f_pointer(address(2), start, [blocks + 1])
      call c_f_pointer(address(3), row, [start(blocks + 1)])
      allocate (tree%of(n), block_of(n), above(blocks), below(blocks), children(blocks), lowest(blocks), &
         number(blocks), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      do b = 1, int(blocks)
         block_of(column(b) + 1:column(b + 1)) = b
         lowest(b) = b
      end do
      children = 0
      do b = 1, int(blocks)
         below(b) = int(column(b + 1) - column(b))
         above(b) = 0
         k = int(start(b) + below(b))
         if (k < start(b + 1)) above(b) = block_of(row(k + 1) + 1)
      end do
      do b = 1, int(blocks)    ! children come first
         if (above(b) == 0) cycle
         children(above(b)) = children(above(b)) + 1
         below(above(b)) = below(above(b)) + below(b)
         lowest(above(b)) = min(lowest(above(b)), lowest(b))
      end do
      ! A tip takes all that is below it; above the tips a block with one child joins it.
      k = 0
      do b = 1, int(blocks)
         number(b) = 0
         if (below(b) <= tip_size .and. above(b) /= 0) then
            if (below(above(b)) <= tip_size) cycle
         end if
         k = k + 1
         if (below(b) > tip_size .and. children(b) == 1 .and. b > 1) then
            if (below(b - 1) > tip_size) k = k - 1
         end if
         number(b) = k
      end do
      allocate (tree%part(k), count(k), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      tree%part(:)%first_block = -1
      edges = 0
      do b = 1, int(blocks)
         if (number(b) == 0) cycle
         associate (part => tree%part(number(b)))
            if (part%first_block < 0) then
               part%first_block = merge(lowest(b), b, below(b) <= tip_size) - 1
               part%first = int(column(part%first_block + 1)) + 1
            end if
            part%last_block = b - 1
            part%last = int(column(b + 1))
            part%lowest = lowest(b)         ! a block yet
            part%edges = int(start(b + 1) - start(b) - (column(b + 1) - column(b)))
            tree%of(part%first:part%last) = number(b)
         end associate
      end do
      do k = 1, size(tree%part)
         associate (part => tree%part(k))
            part%lowest = tree%of(column(part%lowest) + 1)
            part%edge = edges
            edges = edges + part%edges
            if (part%edges > 0) part%parent = number(above(part%last_block + 1))
            ! The tree is in postorder: what lies below lies together.
            if (k > 1) then
               if (part%first /= tree%part(k - 1)%last + 1) status = status_library_failed
            end if
         end associate
      end do
      if (status /= status_ok) return
      allocate (tree%edge(edges), tree%kept(2, edges), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      do k = 1, size(tree%part)
         associate (part => tree%part(k))
            b = int(part%last_block) + 1
            do i = 1, part%edges
               tree%edge(part%edge + i) = int(row(start(b + 1) - part%edges + i)) + 1
            end do
         end associate
      end do
      call place_elements(tree, holders, count, status)
   end subroutine regions_new

   !> Runs of successive elements by region, each in its own order
   subroutine place_elements(tree, holders, count, status)
      type(region_tree), intent(inout) :: tree
      type(group_holder), intent(in) :: holders(:)
      integer, intent(inout) :: count(:)             !! (regions), work
      integer(c_int), intent(out) :: status
      integer, allocatable :: last(:, :)
      integer :: g, e, k, run, info, pass

      allocate (last(2, size(tree%part)), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      do pass = 1, 2      ! count, then fill
         count = 0
         last = 0
         do g = 1, size(holders)
            select type (group => holders(g)%group)
            class is (point_group)
               do e = 1, group%elements
                  k = regions_home(tree, group%equation(:, e))
                  if (last(1, k) /= g .or. last(2, k) /= e - 1) then
                     count(k) = count(k) + 1
                     if (pass == 2) tree%run(:, tree%part(k)%run + count(k)) = [g, e, e]
                  end if
                  if (pass == 2) tree%run(3, tree%part(k)%run + count(k)) = e
                  last(:, k) = [g, e]
               end do
            end select
         end do
         if (pass == 2) exit
         run = 0
         do k = 1, size(tree%part)
            tree%part(k)%run = run
            tree%part(k)%runs = count(k)
            run = run + count(k)
         end do
         allocate (tree%run(3, run), stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end do
   end subroutine place_elements

   !> The region where the first of some equations is eliminated, that of the last equation for held ones
   pure function regions_home(tree, equation) result(k)
      type(region_tree), intent(in) :: tree
      integer(c_int), intent(in) :: equation(:)      !! 0 held, beyond the unknowns moved
      integer :: k, first
      first = int(minval(equation, mask=equation > 0))
      k = size(tree%part)
      if (first <= size(tree%of)) k = tree%of(first)
   end function regions_home

   !> Polynomials of all edges and their energies, from the undamaged elements
   subroutine regions_measure(tree, holders, xy, equation, factor, status)
      type(region_tree), intent(inout) :: tree
      type(group_holder), intent(in) :: holders(:)
      real(wp), intent(in) :: xy(:, :)               !! (2 or 3, nodes) [m]
      integer(c_int), intent(in) :: equation(:, :)   !! (freedoms of a node, nodes), 0 held
      real(wp), intent(in) :: factor(:, :)           !! (freedoms of a node, nodes)
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: energy(:, :, :)
      real(wp) :: k(most_entries, most_entries), phi(most_terms, most_entries)
      real(wp) :: half(most_terms * most_directions, most_entries), middle(3), extent
      integer :: g, e, i, j, d, q, n, own, info, m, all, side(most_entries)

      n = size(tree%of)
      tree%directions = size(equation, 1)
      tree%terms = merge(6, most_terms, size(xy, 1) == 2)
      m = tree%terms
      all = m * tree%directions
      allocate (tree%place(size(xy, 1), n), tree%share(n), tree%direction(n), tree%weight(n), &
         energy(all, all, size(tree%part)), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      extent = 0.0_wp
      do i = 1, size(xy, 1)
         middle(i) = 0.5_wp * (minval(xy(i, :)) + maxval(xy(i, :)))
         extent = max(extent, maxval(xy(i, :)) - minval(xy(i, :)))
      end do
      tree%share = 0.0_wp
      tree%direction = 1
      tree%place = 0.0_wp
      tree%weight = 0.0_wp
      do i = 1, size(xy, 2)
         do d = 1, tree%directions
            q = int(equation(d, i))
            if (q == 0 .or. q > n .or. abs(factor(d, i)) < 1.0e-6_wp) cycle
            if (abs(tree%share(q)) > 0.0_wp) cycle    ! tied freedoms go by the first of them
            tree%share(q) = 1.0_wp / factor(d, i)
            tree%direction(q) = d
            tree%place(:, q) = (xy(:, i) - middle(1:size(xy, 1))) / extent
         end do
      end do
      energy = 0.0_wp
      do g = 1, size(holders)
         associate (group => holders(g)%group)
            do e = 1, group%elements
               call group%matrix(e, k)
               own = regions_home(tree, group%equation(:, e))
               phi = 0.0_wp
               side = 0
               do i = 1, group%freedoms
                  q = int(group%equation(i, e))
                  if (q == 0 .or. q > n) cycle
                  side(i) = m * (tree%direction(q) - 1)
                  phi(:, i) = group%factor(i, e) * tree%share(q) * monomials(tree%place(:, q))
                  do j = 1, group%freedoms
                     if (group%equation(j, e) > 0 .and. group%equation(j, e) <= n) tree%weight(q) = tree%weight(q) + &
                        abs(k(i, j) * group%factor(i, e) * group%factor(j, e))
                  end do
               end do
               half = 0.0_wp
               do i = 1, group%freedoms
                  do j = 1, group%freedoms
                     half(side(j) + 1:side(j) + m, i) = half(side(j) + 1:side(j) + m, i) + k(i, j) * phi(1:m, j)
                  end do
               end do
               do i = 1, group%freedoms
                  do j = 1, m
                     energy(:, side(i) + j, own) = energy(:, side(i) + j, own) + phi(j, i) * half(1:all, i)
                  end do
               end do
            end do
         end associate
      end do
      do own = 1, size(tree%part)
         j = tree%part(own)%parent
         if (j > 0) energy(:, :, j) = energy(:, :, j) + energy(:, :, own)
         call fit_edge(tree, tree%part(own), energy(:, :, own), status)
         if (status /= status_ok) return
      end do
      tree%measured = .true.
   end subroutine regions_measure

   !> Up to the second degree, of x and y or of x, y and z
   pure function monomials(at) result(values)
      real(wp), intent(in) :: at(:)
      real(wp) :: values(most_terms)
      values = 0.0_wp
      if (size(at) == 2) then
         values(1:6) = [1.0_wp, at(1), at(2), at(1)**2, at(1) * at(2), at(2)**2]
      else
         values = [1.0_wp, at(1), at(2), at(3), at(1)**2, at(1) * at(2), at(1) * at(3), at(2)**2, at(2) * at(3), &
            at(3)**2]
      end if
   end function monomials

   !> The monomials about a centre c from those of the whole, not scaled yet
   pure function shifted(c) result(shift)
      real(wp), intent(in) :: c(:)
      real(wp) :: shift(most_terms, most_terms)
      shift = 0.0_wp
      shift(1, 1) = 1.0_wp
      if (size(c) == 2) then
         shift(2, 1:2) = [-c(1), 1.0_wp]
         shift(3, [1, 3]) = [-c(2), 1.0_wp]
         shift(4, [1, 2, 4]) = [c(1)**2, -2.0_wp * c(1), 1.0_wp]
         shift(5, [1, 2, 3, 5]) = [c(1) * c(2), -c(2), -c(1), 1.0_wp]
         shift(6, [1, 3, 6]) = [c(2)**2, -2.0_wp * c(2), 1.0_wp]
      else
         shift(2, 1:2) = [-c(1), 1.0_wp]
         shift(3, [1, 3]) = [-c(2), 1.0_wp]
         shift(4, [1, 4]) = [-c(3), 1.0_wp]
         shift(5, [1, 2, 5]) = [c(1)**2, -2.0_wp * c(1), 1.0_wp]
         shift(6, [1, 2, 3, 6]) = [c(1) * c(2), -c(2), -c(1), 1.0_wp]
         shift(7, [1, 2, 4, 7]) = [c(1) * c(3), -c(3), -c(1), 1.0_wp]
         shift(8, [1, 3, 8]) = [c(2)**2, -2.0_wp * c(2), 1.0_wp]
         shift(9, [1, 3, 4, 9]) = [c(2) * c(3), -c(3), -c(2), 1.0_wp]
         shift(10, [1, 4, 10]) = [c(3)**2, -2.0_wp * c(3), 1.0_wp]
      end if
   end function shifted

   !> Polynomials that are orthonormal over the weighted equations of an edge, and their energies in the region
   pure subroutine fit_edge(tree, part, energy, status)
      type(region_tree), intent(in) :: tree
      type(region), intent(inout) :: part
      real(wp), intent(in) :: energy(:, :)           !! of the monomials of the whole [N/m]
      integer(c_int), intent(out) :: status
      real(wp) :: gram(most_terms, most_terms), shift(most_terms, most_terms), values(most_terms), at(3)
      real(wp) :: rows(most_terms, most_terms), fit(most_terms, most_terms * most_directions)
      real(wp) :: full(most_terms, most_terms * most_directions)
      real(wp) :: whole(most_terms * most_directions, most_terms * most_directions)
      integer :: of(most_terms * most_directions), i, j, d, q, count, terms, axes, info

      terms = tree%terms
      axes = size(tree%place, 1)
      status = status_ok
      if (part%edges == 0) return
      part%centre = 0.0_wp
      do i = part%edge + 1, part%edge + part%edges
         part%centre(1:axes) = part%centre(1:axes) + tree%place(:, tree%edge(i)) / part%edges
      end do
      part%size = 1.0e-6_wp
      do i = part%edge + 1, part%edge + part%edges
         part%size = max(part%size, maxval(abs(tree%place(:, tree%edge(i)) - part%centre(1:axes))))
      end do
      shift = shifted(part%centre(1:axes))
      shift(2:1 + axes, :) = shift(2:1 + axes, :) / part%size
      shift(2 + axes:, :) = shift(2 + axes:, :) / part%size**2
      count = 0
      do d = 1, tree%directions
         gram = 0.0_wp
         do i = part%edge + 1, part%edge + part%edges
            q = tree%edge(i)
            if (tree%direction(q) /= d) cycle
            at(1:axes) = (tree%place(:, q) - part%centre(1:axes)) / part%size
            values = tree%share(q) * monomials(at(1:axes))
            do j = 1, terms
               gram(:, j) = gram(:, j) + tree%weight(q) * values(j) * values
            end do
         end do
         call inverse_cholesky(gram, rows)
         do i = 1, terms      ! in a plane and along a line monomials depend on others: rows of zeros
            if (.not. any(abs(rows(i, :)) > 0.0_wp)) cycle
            count = count + 1
            of(count) = d
            fit(:, count) = rows(i, :)
            do j = 1, terms
               full(j, count) = dot_product(rows(i, :), shift(:, j))
            end do
         end do
      end do
      allocate (part%fit(terms, count), part%of(count), part%energy(count, count), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      part%fit(:, :) = fit(1:terms, 1:count)
      part%of(:) = of(1:count)
      do i = 1, count
         d = terms * (of(i) - 1)
         whole(:, i) = 0.0_wp
         do j = 1, terms
            whole(1:size(energy, 1), i) = whole(1:size(energy, 1), i) + energy(:, d + j) * full(j, i)
         end do
      end do
      do i = 1, count
         do q = 1, count
            d = terms * (of(q) - 1)
            part%energy(q, i) = dot_product(full(1:terms, q), whole(d + 1:d + terms, i))
         end do
      end do
      part%stiffest = maxval(abs(part%energy))
   end subroutine fit_edge

   !> Inverse of the lower Cholesky factor; a monomial that depends on those before it is left out (a row of zeros)
   pure subroutine inverse_cholesky(gram, inverse)
      real(wp), intent(in) :: gram(most_terms, most_terms)
      real(wp), intent(out) :: inverse(most_terms, most_terms)
      real(wp), parameter :: dependent = 1.0e-6_wp
      real(wp) :: row(most_terms), along
      integer :: i, j
      inverse = 0.0_wp
      do i = 1, most_terms    ! Gram-Schmidt on the monomials, twice over
         row = 0.0_wp
         row(i) = 1.0_wp
         do j = 1, 2 * (i - 1)
            associate (other => inverse(1 + mod(j - 1, i - 1), :))
               row = row - dot_product(other, matmul(gram, row)) * other
            end associate
         end do
         along = dot_product(row, matmul(gram, row))
         if (along > dependent * gram(i, i) .and. along > 0.0_wp) inverse(i, :) = row / sqrt(along)
      end do
   end subroutine inverse_cholesky

   !> All displacements are up to date: from here on regions may wait
   pure subroutine regions_settled(tree, ua, ub)
      type(region_tree), intent(inout) :: tree
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      integer :: i
      do i = 1, size(tree%edge)
         tree%kept(:, i) = [ua(tree%edge(i)), ub(tree%edge(i))]
      end do
      tree%settled = .false.
      tree%part(:)%failed = 0
      tree%part(:)%patience = 0
      tree%part(:)%seen = tree%now
   end subroutine regions_settled

   !> Bring a region up to date after those above it; on the path of an event z holds its forces gone forward
   subroutine regions_bring(tree, k, handle, path, ua, ub, z, status)
      type(region_tree), intent(inout) :: tree
      integer, intent(in) :: k
      type(c_ptr), intent(in) :: handle
      logical, intent(in) :: path
      real(wp), intent(inout) :: ua(0:)
      real(wp), intent(inout) :: ub(0:)
      real(wp), intent(inout), contiguous :: z(:, :)   !! (n, 2), work
      integer(c_int), intent(out) :: status
      call move_region(tree, tree%part(k), handle, path, ua, ub, z, status)
      call keep_edge(tree, tree%part(k), ua, ub)
      tree%part(k)%seen = tree%now
   end subroutine regions_bring

   !> The displacements of the equations of one region follow those of its edge
   subroutine move_region(tree, part, handle, path, ua, ub, z, status)
      type(region_tree), intent(in) :: tree
      type(region), intent(in) :: part
      type(c_ptr), intent(in) :: handle
      logical, intent(in) :: path
      real(wp), intent(inout) :: ua(0:)
      real(wp), intent(inout) :: ub(0:)
      real(wp), intent(inout), contiguous :: z(:, :)
      integer(c_int), intent(out) :: status
      integer :: i, q
      do i = part%edge + 1, part%edge + part%edges
         q = tree%edge(i)
         z(q, 1) = ua(q) - tree%kept(1, i)
         z(q, 2) = ub(q) - tree%kept(2, i)
      end do
      if (.not. path) z(part%first:part%last, :) = 0.0_wp
      status = extrados_sparse_backward(handle, part%first_block, part%last_block, 2_c_int, z)
      ua(part%first:part%last) = ua(part%first:part%last) + z(part%first:part%last, 1)
      ub(part%first:part%last) = ub(part%first:part%last) + z(part%first:part%last, 2)
   end subroutine move_region

   pure subroutine keep_edge(tree, part, ua, ub)
      type(region_tree), intent(inout) :: tree
      type(region), intent(in) :: part
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      integer :: i
      do i = part%edge + 1, part%edge + part%edges
         tree%kept(:, i) = [ua(tree%edge(i)), ub(tree%edge(i))]
      end do
   end subroutine keep_edge

   !> All displacements as they are now, to be read: what waits goes on waiting
   subroutine regions_made_up(tree, handle, ua, ub, z, status)
      type(region_tree), intent(in) :: tree
      type(c_ptr), intent(in) :: handle
      real(wp), intent(inout) :: ua(0:)              !! copies
      real(wp), intent(inout) :: ub(0:)
      real(wp), intent(inout), contiguous :: z(:, :)
      integer(c_int), intent(out) :: status
      integer :: k
      status = status_ok
      do k = size(tree%part), 1, -1
         call move_region(tree, tree%part(k), handle, .false., ua, ub, z, status)
         if (status /= status_ok) return
      end do
   end subroutine regions_made_up

   !> Choose the multipliers around the limits found; margins are to be taken of all regions then
   pure subroutine regions_window(tree, hi, lo)
      type(region_tree), intent(inout) :: tree
      real(wp), intent(in) :: hi
      real(wp), intent(in) :: lo
      real(wp) :: top, bottom, span, value
      integer :: i, j
      top = max(hi, lo)
      bottom = min(hi, lo)
      span = max(min(top - bottom, max(abs(top), abs(bottom))), 1.0e-3_wp * max(abs(top), abs(bottom)))
      tree%lambda = [bottom - span * [0.5_wp, 0.1_wp, 0.02_wp], bottom + 0.1_wp * span, &
         top - span * [0.3_wp, 0.1_wp, 0.03_wp], top + span * [0.02_wp, 0.1_wp, 0.5_wp]]
      do i = 2, levels
         value = tree%lambda(i)
         j = i - 1
         do while (j >= 1)
            if (tree%lambda(j) <= value) exit
            tree%lambda(j + 1) = tree%lambda(j)
            j = j - 1
         end do
         tree%lambda(j + 1) = value
      end do
   end subroutine regions_window

   !> Can no point below the region have left its limits at the multipliers hi and lo? Both lie in the window
   subroutine regions_calm(tree, k, ua, ub, hi, lo, calm)
      type(region_tree), intent(inout) :: tree
      integer, intent(in) :: k
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: hi
      real(wp), intent(in) :: lo
      logical, intent(out) :: calm
      real(wp) :: at_hi, at_lo
      calm = .false.
      associate (part => tree%part(k))
         if (part%patience > 0) then
            part%patience = part%patience - 1
            return
         end if
         at_hi = between(tree%lambda, part%margin, hi)
         at_lo = between(tree%lambda, part%margin, lo)
         if (.not. (at_hi > 0.0_wp .and. at_lo > 0.0_wp)) return
         call edge_motion(tree, part, ua, ub)
         calm = reach(part%moved, hi) < 0.999999_wp * at_hi .and. reach(part%moved, lo) < 0.999999_wp * at_lo
         part%failed = merge(0, part%failed + 1, calm)
         if (.not. calm) part%patience = min(2**min(part%failed, 10) - 1, most_patience)
      end associate
   end subroutine regions_calm

   !> Margins are concave in lambda: the chord lies below
   pure function between(lambda, margin, at) result(value)
      real(wp), intent(in) :: lambda(levels)
      real(wp), intent(in) :: margin(levels)
      real(wp), intent(in) :: at
      real(wp) :: value, width
      integer :: i
      value = -1.0_wp
      if (at < lambda(1) .or. at > lambda(levels)) return
      i = 1
      do while (i < levels - 1)
         if (lambda(i + 1) >= at) exit
         i = i + 1
      end do
      width = lambda(i + 1) - lambda(i)
      value = min(margin(i), margin(i + 1))
      if (width > 0.0_wp) value = margin(i) + (margin(i + 1) - margin(i)) * ((at - lambda(i)) / width)
   end function between

   !> Bound of sqrt(2 U) of the edge's motion at a multiplier
   pure function reach(moved, lambda) result(value)
      real(wp), intent(in) :: moved(6)          !! see edge_motion
      real(wp), intent(in) :: lambda
      real(wp) :: value
      value = sqrt(max(moved(1) + lambda * (2.0_wp * moved(2) + lambda * moved(3)), 0.0_wp)) &
         + sqrt(max(moved(4) + lambda * (2.0_wp * moved(5) + lambda * moved(6)), 0.0_wp))
   end function reach

   !> Energies of the motion of an edge since the region was brought: of the polynomial (AA, AB, BB) and of
   !> what it leaves over
   pure subroutine edge_motion(tree, part, ua, ub)
      type(region_tree), intent(in) :: tree
      type(region), intent(inout) :: part
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), parameter :: rounding = 1.0e-12_wp
      real(wp) :: moment(most_terms, most_directions, 2), norm(3), x(3), phi(most_terms), da, db, w, stiff, products(6)
      real(wp) :: a(most_terms * most_directions), b(most_terms * most_directions), ha, hb
      integer :: i, j, q, d, terms, axes
      part%moved = 0.0_wp
      if (part%edges == 0) return
      terms = tree%terms
      axes = size(tree%place, 1)
      moment = 0.0_wp
      norm = 0.0_wp
      do i = part%edge + 1, part%edge + part%edges
         q = tree%edge(i)
         da = ua(q) - tree%kept(1, i)
         db = ub(q) - tree%kept(2, i)
         w = tree%weight(q)
         norm = norm + w * [da * da, da * db, db * db]
         w = w * tree%share(q)
         x(1:axes) = (tree%place(:, q) - part%centre(1:axes)) / part%size
         if (axes == 2) then
            phi(1:6) = [1.0_wp, x(1), x(2), x(1) * x(1), x(1) * x(2), x(2) * x(2)]
         else
            phi = [1.0_wp, x(1), x(2), x(3), x(1) * x(1), x(1) * x(2), x(1) * x(3), x(2) * x(2), x(2) * x(3), &
               x(3) * x(3)]
         end if
         d = tree%direction(q)
         do j = 1, terms
            moment(j, d, 1) = moment(j, d, 1) + (w * da) * phi(j)
            moment(j, d, 2) = moment(j, d, 2) + (w * db) * phi(j)
         end do
      end do
      do i = 1, size(part%of)
         a(i) = 0.0_wp
         b(i) = 0.0_wp
         do j = 1, terms
            a(i) = a(i) + part%fit(j, i) * moment(j, part%of(i), 1)
            b(i) = b(i) + part%fit(j, i) * moment(j, part%of(i), 2)
         end do
      end do
      products = 0.0_wp
      do i = 1, size(part%of)
         ha = 0.0_wp
         hb = 0.0_wp
         do j = 1, size(part%of)
            ha = ha + part%energy(j, i) * a(j)
            hb = hb + part%energy(j, i) * b(j)
         end do
         products = products + [a(i) * ha, a(i) * hb, b(i) * hb, a(i) * a(i), a(i) * b(i), b(i) * b(i)]
      end do
      stiff = rounding * part%stiffest
      part%moved(1:3) = products(1:3) + stiff * products(4:6)
      part%moved(4:6) = (1.0_wp + rounding) * norm - products(4:6)
   end subroutine edge_motion

   !> Margins of the regions that were brought, from their points and from what is left to the regions below
   subroutine regions_margins(tree, holders, ua, ub)
      type(region_tree), intent(inout) :: tree
      type(group_holder), intent(in) :: holders(:)
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp) :: least(levels)
      integer :: k, i, parent
      do k = 1, size(tree%part)
         if (tree%part(k)%seen == tree%now) tree%part(k)%margin = huge(1.0_wp)
      end do
      do k = 1, size(tree%part)      ! children first: they have lowered the margin of their parent already
         parent = tree%part(k)%parent
         if (parent > 0) then
            if (tree%part(parent)%seen /= tree%now) cycle
         else if (tree%part(k)%seen /= tree%now) then
            cycle
         end if
         if (tree%part(k)%seen == tree%now) then
            least = tree%part(k)%margin
            if (tree%part(k)%patience > 0 .or. maxval(least) <= 0.0_wp) then
               least = -1.0_wp
            else
               do i = tree%part(k)%run + 1, tree%part(k)%run + tree%part(k)%runs
                  select type (group => holders(tree%run(1, i))%group)
                  class is (point_group)
                     call group%margin(tree%run(2, i), tree%run(3, i), ua, ub, tree%lambda, least)
                  end select
               end do
            end if
            tree%part(k)%margin = least
         else
            do i = 1, levels
               least(i) = tree%part(k)%margin(i) - reach(tree%part(k)%moved, tree%lambda(i))
            end do
         end if
         if (parent > 0) tree%part(parent)%margin = min(tree%part(parent)%margin, least)
      end do
   end subroutine regions_margins

end module sla_regions
